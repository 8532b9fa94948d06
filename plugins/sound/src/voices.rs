//! Who has a voice, and what becomes of it.

use bevy::ecs::entity::{Entity, EntityHashMap};
use bevy::ecs::message::{MessageReader, MessageWriter};
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::log::warn;
use bevy::math::Vec3;
use bevy::time::{Time, Virtual};
use bevy::transform::components::GlobalTransform;
use kira::sound::PlaybackState;
use kira::sound::static_sound::StaticSoundHandle;

use crate::choose::{Candidate, choose};
use crate::error::{SoundError, SoundFault};
use crate::id::SoundId;
use crate::output::{Begin, INAUDIBLE, SoundOutput, bend, fade_out, glide};
use crate::parts::{Loudness, PlaySound, SoundEmitter, SoundListener};
use crate::settings::{MOST_VOICES, SoundCounters, SoundSettings};
use crate::sounds::Sounds;
use crate::space::{Ears, Heard, delay};

/// Whose voice it is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Of {
    Emitter(Entity),
    Shot {
        place: Option<Vec3>,
        loudness: Loudness,
    },
}

struct Voice {
    of: Of,
    sound: SoundId,
    handle: StaticSoundHandle,
    heard: Heard,
    loudness: Loudness,
    kept: bool,
}

/// Somebody who would be heard.
struct Source {
    voice: Option<usize>,
    of: Of,
    sound: SoundId,
    loudness: Loudness,
    heard: Heard,
}

/// All voices, and memory that is used again in each frame.
#[derive(Resource, Default)]
pub(crate) struct Voices {
    live: Vec<Voice>,
    sources: Vec<Source>,
    candidates: Vec<Candidate>,
    speaking: EntityHashMap<usize>,
    turn: u32,
    logged: u32,
}

impl Voices {
    /// Everybody is silent: the output is gone.
    pub(crate) fn clear(&mut self) {
        self.live.clear();
    }

    /// Says what was refused, and logs the first of each kind.
    pub(crate) fn refuse(&mut self, error: SoundError, faults: &mut MessageWriter<SoundFault>) {
        let kind = 1 << error.kind();
        if self.logged & kind == 0 {
            self.logged |= kind;
            warn!("{error}");
        }
        faults.write(SoundFault(error));
    }

    /// Again said in the log when it comes again.
    pub(crate) fn forgive(&mut self) {
        self.logged = 0;
    }
}

/// What was refused in a frame.
#[derive(Default)]
struct Refused {
    emitters: u32,
    messages: u32,
    unknown: Option<SoundId>,
}

fn heard(ears: &Ears, place: Option<Vec3>, loudness: &Loudness) -> Heard {
    match place {
        Some(place) => ears.hear(place, loudness),
        None => Heard {
            gain: loudness.volume,
            ..Heard::default()
        },
    }
}

/// One frame of everything that is heard.
pub(crate) fn tick(
    settings: Res<SoundSettings>,
    sounds: Res<Sounds>,
    time: Option<Res<Time<Virtual>>>,
    listeners: Query<(Entity, &GlobalTransform), With<SoundListener>>,
    emitters: Query<(Entity, &SoundEmitter, &GlobalTransform)>,
    mut shots: MessageReader<PlaySound>,
    mut output: ResMut<SoundOutput>,
    mut voices: ResMut<Voices>,
    mut counters: ResMut<SoundCounters>,
    mut faults: MessageWriter<SoundFault>,
) {
    counters.frames += 1;
    output.set_levels(&settings);
    let paused = time.as_ref().is_some_and(|time| time.is_paused());
    output.set_paused(paused);
    let listener = listeners.iter().min_by_key(|(entity, _)| *entity);
    let ears = listener.and_then(|(_, place)| Ears::new(&place.affine()));
    // Who is nowhere hears what was heard before. What is played in a pause is not kept for later.
    let (false, Some(ears)) = (paused, ears) else {
        shots.clear();
        return;
    };
    let voices = &mut *voices;
    let mut refused = Refused::default();
    gather_live(voices, &ears);
    gather_emitters(
        voices,
        &ears,
        &sounds,
        &emitters,
        &mut counters,
        &mut refused,
    );
    let first_new = voices.sources.len();
    gather_shots(
        voices,
        &ears,
        &sounds,
        shots.read(),
        &mut counters,
        &mut refused,
    );

    voices.candidates.clear();
    let of = |(number, source): (usize, &Source)| Candidate {
        priority: source.loudness.priority,
        gain: source.heard.gain,
        sounds: source.voice.is_some(),
        number: number as u64,
    };
    voices
        .candidates
        .extend(voices.sources.iter().enumerate().map(of));
    let most = settings.voices.clamp(1, MOST_VOICES) as usize;
    let count = choose(&mut voices.candidates, most);
    let lost = &voices.candidates[count..];
    let gave_way = |one: &&Candidate| one.sounds || one.number >= first_new as u64;
    counters.crowded_out += lost.iter().filter(gave_way).count() as u64;
    counters.audible = voices.candidates.len() as u32;
    // Voices that began earlier keep their place in the list whatever the choice put first.
    voices.candidates.truncate(count);
    voices.candidates.sort_unstable_by_key(|one| one.number);

    let now = time.map_or(0.0, |time| time.elapsed_secs_f64());
    for at in 0..voices.candidates.len() {
        let number = voices.candidates[at].number as usize;
        speak(
            voices,
            number,
            now,
            &settings,
            &sounds,
            &mut output,
            &mut counters,
        );
    }
    voices.live.retain_mut(|voice| {
        if !voice.kept {
            fade_out(&mut voice.handle);
        }
        voice.kept
    });
    counters.voices = voices.live.len() as u32;
    tell(voices, refused, &mut counters, &mut faults);
}

/// One-shots that have not ended, and which voice is whose.
fn gather_live(voices: &mut Voices, ears: &Ears) {
    voices
        .live
        .retain(|voice| voice.handle.state() != PlaybackState::Stopped);
    voices.sources.clear();
    voices.speaking.clear();
    for (at, voice) in voices.live.iter_mut().enumerate() {
        voice.kept = false;
        match voice.of {
            Of::Emitter(entity) => {
                voices.speaking.insert(entity, at);
            }
            Of::Shot { place, loudness } => voices.sources.push(Source {
                voice: Some(at),
                of: voice.of,
                sound: voice.sound,
                loudness,
                heard: heard(ears, place, &loudness),
            }),
        }
    }
}

fn gather_emitters(
    voices: &mut Voices,
    ears: &Ears,
    sounds: &Sounds,
    emitters: &Query<(Entity, &SoundEmitter, &GlobalTransform)>,
    counters: &mut SoundCounters,
    refused: &mut Refused,
) {
    counters.emitters = 0;
    for (entity, emitter, place) in emitters {
        counters.emitters += 1;
        let place = place.translation();
        let (true, Some(loudness)) = (place.is_finite(), emitter.loudness.checked()) else {
            refused.emitters += 1;
            continue;
        };
        let heard = heard(ears, (!emitter.everywhere).then_some(place), &loudness);
        if heard.gain < INAUDIBLE {
            continue;
        }
        if sounds.get(emitter.sound, 0).is_none() {
            refused.unknown.get_or_insert(emitter.sound);
            continue;
        }
        let voice = voices.speaking.get(&entity).copied().filter(|at| {
            // Another sound, or another volume of the settings, is another voice.
            let voice = &voices.live[*at];
            voice.sound == emitter.sound && voice.loudness.bus == loudness.bus
        });
        voices.sources.push(Source {
            voice,
            of: Of::Emitter(entity),
            sound: emitter.sound,
            loudness,
            heard,
        });
    }
}

fn gather_shots<'a>(
    voices: &mut Voices,
    ears: &Ears,
    sounds: &Sounds,
    shots: impl Iterator<Item = &'a PlaySound>,
    counters: &mut SoundCounters,
    refused: &mut Refused,
) {
    for shot in shots {
        let finite = shot.place.is_none_or(Vec3::is_finite);
        let (true, Some(loudness)) = (finite, shot.loudness.checked()) else {
            refused.messages += 1;
            continue;
        };
        if sounds.get(shot.sound, 0).is_none() {
            refused.unknown.get_or_insert(shot.sound);
            continue;
        }
        let heard = heard(ears, shot.place, &loudness);
        if heard.gain < INAUDIBLE {
            counters.unheard += 1;
            continue;
        }
        voices.sources.push(Source {
            voice: None,
            of: Of::Shot {
                place: shot.place,
                loudness,
            },
            sound: shot.sound,
            loudness,
            heard,
        });
    }
}

/// Gives a source its voice, or lets it go on.
fn speak(
    voices: &mut Voices,
    number: usize,
    now: f64,
    settings: &SoundSettings,
    sounds: &Sounds,
    output: &mut SoundOutput,
    counters: &mut SoundCounters,
) {
    let source = &voices.sources[number];
    if let Some(at) = source.voice {
        let voice = &mut voices.live[at];
        voice.kept = true;
        if glide(&mut voice.handle, voice.heard, source.heard) {
            voice.heard = source.heard;
        }
        if source.loudness.rate != voice.loudness.rate {
            bend(&mut voice.handle, source.loudness.rate);
        }
        voice.loudness = source.loudness;
        return;
    }
    let mut begin = Begin {
        heard: source.heard,
        rate: source.loudness.rate,
        bus: source.loudness.bus,
        delay: 0.0,
        looped: None,
    };
    let turn = match source.of {
        Of::Emitter(entity) => {
            // It has been going on all the time, and no two of one sound are in step.
            let length = sounds
                .get(source.sound, 0)
                .map_or(1.0, |samples| samples.duration().as_secs_f64());
            let own = f64::from(entity.index_u32().wrapping_mul(2_654_435_769)) / 4_294_967_296.0;
            begin.looped = Some((now * f64::from(begin.rate) + own * length).rem_euclid(length));
            0
        }
        Of::Shot { place, .. } => {
            if place.is_some() {
                begin.delay = delay(source.heard.distance, settings.speed_of_sound);
            }
            voices.turn = voices.turn.wrapping_add(1);
            voices.turn
        }
    };
    let Some(samples) = sounds.get(source.sound, turn) else {
        return;
    };
    match output.play(samples, &begin) {
        Some(handle) => {
            counters.played += u64::from(begin.looped.is_none());
            voices.live.push(Voice {
                of: source.of,
                sound: source.sound,
                handle,
                heard: source.heard,
                loudness: source.loudness,
                kept: true,
            });
        }
        None => counters.crowded_out += 1,
    }
}

/// Says what was refused.
fn tell(
    voices: &mut Voices,
    refused: Refused,
    counters: &mut SoundCounters,
    faults: &mut MessageWriter<SoundFault>,
) {
    counters.refused += u64::from(refused.emitters + refused.messages);
    for (what, count) in [
        ("emitters", refused.emitters),
        ("messages", refused.messages),
    ] {
        if count > 0 {
            voices.refuse(SoundError::NotFinite { what, count }, faults);
        }
    }
    if let Some(id) = refused.unknown {
        counters.refused += 1;
        voices.refuse(SoundError::Unknown(id), faults);
    }
}
