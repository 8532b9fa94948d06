//! What plays: a device, or samples in its place.

use std::time::Duration;

use bevy::ecs::resource::Resource;
use bevy::math::ops;
use kira::backend::Backend;
#[cfg(feature = "device")]
use kira::backend::cpal::CpalBackend;
use kira::sound::static_sound::{StaticSoundData, StaticSoundHandle, StaticSoundSettings};
use kira::track::{MainTrackBuilder, TrackBuilder, TrackHandle};
use kira::{AudioManager, AudioManagerSettings, Capacities, Decibels, Easing, StartTime, Tween};

use crate::error::SoundError;
use crate::limiter::LimiterBuilder;
use crate::offline::Offline;
use crate::parts::Bus;
use crate::samples::Samples;
use crate::settings::{MOST_VOICES, SoundSettings, SoundTarget, share};
use crate::space::Heard;

/// Amplitude below which nothing is heard: −60 dB, where Kira is silent.
pub const INAUDIBLE: f32 = 0.001;

/// Voices fade in and out, and pauses too: no click, and nobody hears that it took so long.
const FADE: Duration = Duration::from_millis(30);

/// Changes of loudness and side take as long as a frame of 60 a second, about.
const GLIDE: Duration = Duration::from_millis(20);

fn tween(duration: Duration) -> Tween {
    Tween {
        start_time: StartTime::Immediate,
        duration,
        easing: Easing::Linear,
    }
}

/// An amplitude as Kira has it.
pub(crate) fn decibels(amplitude: f32) -> Decibels {
    if amplitude < INAUDIBLE {
        Decibels::SILENCE
    } else {
        Decibels(20.0 / std::f32::consts::LN_10 * ops::ln(amplitude))
    }
}

enum Manager {
    Samples(Box<AudioManager<Offline>>),
    #[cfg(feature = "device")]
    Device(Box<AudioManager<CpalBackend>>),
}

/// The open output. There is one while sound is on and somebody listens.
#[derive(Resource)]
pub struct SoundOutput {
    manager: Manager,
    effects: TrackHandle,
    ambience: TrackHandle,
    target: SoundTarget,
    levels: [f32; 3],
    paused: bool,
}

/// How a voice begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Begin {
    pub heard: Heard,
    pub rate: f32,
    pub bus: Bus,
    /// Seconds until it begins.
    pub delay: f32,
    /// It repeats, from so many seconds on.
    pub looped: Option<f64>,
}

/// Whether nothing on this machine can play, as far as files tell: ALSA would say the same in a dozen lines of its own.
#[cfg(all(feature = "device", target_os = "linux"))]
fn no_sound_system() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let run = std::env::var_os("XDG_RUNTIME_DIR").map(std::path::PathBuf::from);
    let served =
        run.is_some_and(|run| run.join("pulse").exists() || run.join("pipewire-0").exists());
    let home = std::env::var_os("HOME").map(std::path::PathBuf::from);
    let told = home.is_some_and(|home| home.join(".asoundrc").exists())
        || std::path::Path::new("/etc/asound.conf").exists();
    let card = std::fs::read_dir("/dev/snd").is_ok_and(|files| {
        files
            .flatten()
            .any(|file| file.file_name().to_string_lossy().starts_with("pcm"))
    });
    !(set("PULSE_SERVER") || served || told || card)
}

#[cfg(feature = "device")]
fn device() -> Result<(Manager, TrackHandle, TrackHandle), SoundError> {
    #[cfg(target_os = "linux")]
    if no_sound_system() {
        let reason = "this machine has no sound card, PulseAudio or PipeWire";
        return Err(SoundError::Device(reason.to_owned()));
    }
    let (manager, effects, ambience) = with::<CpalBackend>(Default::default())
        .map_err(|error| SoundError::Device(error.to_string()))?;
    Ok((Manager::Device(Box::new(manager)), effects, ambience))
}

#[cfg(not(feature = "device"))]
fn device() -> Result<(Manager, TrackHandle, TrackHandle), SoundError> {
    Err(SoundError::NoDevice)
}

fn with<B: Backend>(
    settings: B::Settings,
) -> Result<(AudioManager<B>, TrackHandle, TrackHandle), B::Error> {
    let mut manager = AudioManager::<B>::new(AudioManagerSettings {
        capacities: Capacities {
            sub_track_capacity: 2,
            send_track_capacity: 0,
            clock_capacity: 0,
            modulator_capacity: 0,
            listener_capacity: 0,
        },
        main_track_builder: MainTrackBuilder::new()
            .sound_capacity(0)
            .with_effect(LimiterBuilder),
        internal_buffer_size: 128,
        backend_settings: settings,
    })?;
    // Those that fade out need room beside those that are heard.
    let mut track = || {
        let builder = TrackBuilder::new()
            .sub_track_capacity(0)
            .sound_capacity(2 * MOST_VOICES as usize);
        manager
            .add_sub_track(builder)
            .expect("room for two was asked for above")
    };
    let (effects, ambience) = (track(), track());
    Ok((manager, effects, ambience))
}

impl SoundOutput {
    /// Opens what is asked for. A device has a thread of its own; samples have none.
    ///
    /// # Errors
    /// [`SoundError::Device`], [`SoundError::NoDevice`], [`SoundError::Rate`].
    pub fn open(target: SoundTarget) -> Result<Self, SoundError> {
        let (manager, effects, ambience) = match target {
            SoundTarget::Device => device()?,
            SoundTarget::Samples { rate } => {
                if !(8000..=192_000).contains(&rate) {
                    return Err(SoundError::Rate(rate));
                }
                let Ok((manager, effects, ambience)) = with::<Offline>(rate);
                (Manager::Samples(Box::new(manager)), effects, ambience)
            }
        };
        Ok(Self {
            manager,
            effects,
            ambience,
            target,
            levels: [1.0; 3],
            paused: false,
        })
    }

    /// What it was opened for.
    #[must_use]
    pub fn target(&self) -> SoundTarget {
        self.target
    }

    /// The next `frames`, left and right, of an output of [`SoundTarget::Samples`]; `None` of a device.
    pub fn render(&mut self, frames: usize) -> Option<Vec<[f32; 2]>> {
        match &mut self.manager {
            Manager::Samples(manager) => Some(manager.backend_mut().render(frames)),
            #[cfg(feature = "device")]
            Manager::Device(_) => None,
        }
    }

    /// Takes over the volumes of the settings, where they changed.
    pub(crate) fn set_levels(&mut self, settings: &SoundSettings) {
        let next = [settings.volume, settings.effects, settings.ambience].map(share);
        let glide = tween(GLIDE);
        if next[0] != self.levels[0] {
            match &mut self.manager {
                Manager::Samples(manager) => {
                    manager.main_track().set_volume(decibels(next[0]), glide)
                }
                #[cfg(feature = "device")]
                Manager::Device(manager) => {
                    manager.main_track().set_volume(decibels(next[0]), glide)
                }
            }
        }
        if next[1] != self.levels[1] {
            self.effects.set_volume(decibels(next[1]), glide);
        }
        if next[2] != self.levels[2] {
            self.ambience.set_volume(decibels(next[2]), glide);
        }
        self.levels = next;
    }

    /// Holds everything, or goes on where it was.
    pub(crate) fn set_paused(&mut self, paused: bool) {
        if paused == self.paused {
            return;
        }
        self.paused = paused;
        for track in [&mut self.effects, &mut self.ambience] {
            if paused {
                track.pause(tween(FADE));
            } else {
                track.resume(tween(FADE));
            }
        }
    }

    /// A voice; `None` where there is no room.
    pub(crate) fn play(&mut self, samples: &Samples, begin: &Begin) -> Option<StaticSoundHandle> {
        let mut settings = StaticSoundSettings::new()
            .volume(decibels(begin.heard.gain))
            .panning(begin.heard.pan)
            .playback_rate(f64::from(begin.rate));
        if begin.delay > 0.0 {
            settings = settings.start_time(Duration::from_secs_f32(begin.delay));
        }
        if let Some(from) = begin.looped {
            settings = settings
                .loop_region(0.0..)
                .start_position(from)
                .fade_in_tween(tween(FADE));
        }
        let data = StaticSoundData {
            sample_rate: samples.rate(),
            frames: samples.frames(),
            settings,
            slice: None,
        };
        let track = match begin.bus {
            Bus::Effects => &mut self.effects,
            Bus::Ambience => &mut self.ambience,
        };
        track.play(data).ok()
    }
}

/// Lets a voice change from what was heard of it.
pub(crate) fn glide(handle: &mut StaticSoundHandle, was: Heard, is: Heard) -> bool {
    // A quarter of a decibel, or three degrees: less is not heard.
    let louder = (is.gain - was.gain).abs() > 0.03 * was.gain.max(INAUDIBLE);
    let aside = (is.pan - was.pan).abs() > 0.03;
    if louder {
        handle.set_volume(decibels(is.gain), tween(GLIDE));
    }
    if aside {
        handle.set_panning(is.pan, tween(GLIDE));
    }
    louder || aside
}

/// Lets a voice end.
pub(crate) fn fade_out(handle: &mut StaticSoundHandle) {
    handle.stop(tween(FADE));
}

/// Lets it change its pitch.
pub(crate) fn bend(handle: &mut StaticSoundHandle, rate: f32) {
    handle.set_playback_rate(f64::from(rate), tween(GLIDE));
}
