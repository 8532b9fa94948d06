//! Another program that moves balls: started, told and listened to.

use super::messages::{Greeting, Moved, PROTOCOL, ProgramError, Ready, Refusal, Step, World};
use super::method::{RADIUS, SECONDS, Walkers};
use super::terrain::Terrain;
use bevy::math::{DVec3, Vec3};
use dolomite_collision::MoveSettings;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

/// How long it may take to say who it is.
const GREETS: Duration = Duration::from_secs(30);

/// How long it may take to answer: far longer than a step of many balls, so that only who hangs is given up.
const ANSWERS: Duration = Duration::from_secs(1800);

/// The longest line that is listened to, bytes: a step of a million balls has a quarter of it at most.
const LINE: u64 = 1 << 28;

/// What it is waited for after it has closed its output.
const ENDS: Duration = Duration::from_secs(1);

/// A program that moves balls.
pub struct Program {
    name: String,
    greeting: Greeting,
    asks: Sender<String>,
    answers: Receiver<io::Result<String>>,
    child: Option<Child>,
    places: Vec<Vec3>,
}

impl Program {
    /// Starts it and hears its greeting.
    ///
    /// # Errors
    /// [`ProgramError`].
    pub fn start(path: &Path) -> Result<Self, ProgramError> {
        Self::start_within(path, GREETS)
    }

    fn start_within(path: &Path, wait: Duration) -> Result<Self, ProgramError> {
        let name = path.display().to_string();
        let refused = |source| ProgramError::Start {
            program: name.clone(),
            source,
        };
        let mut child = Command::new(path)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(refused)?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(refused(io::ErrorKind::BrokenPipe.into()));
        };
        Self::greeted(name, BufReader::new(output), input, Some(child), wait)
    }

    /// Who speaks and listens here, once it has greeted.
    fn greeted(
        name: String,
        output: impl BufRead + Send + 'static,
        input: impl Write + Send + 'static,
        child: Option<Child>,
        wait: Duration,
    ) -> Result<Self, ProgramError> {
        let (asks, asked) = channel();
        let (said, answers) = channel();
        // Both directions on a thread of their own: who neither reads nor writes is not waited for beyond its time.
        thread::spawn(move || speak(output, input, &asked, &said));
        let mut program = Self {
            name,
            greeting: Greeting {
                protocol: 0,
                name: String::new(),
                profile: String::new(),
            },
            asks,
            answers,
            child,
            places: Vec::new(),
        };
        program.greeting = program.hear(wait)?;
        if program.greeting.protocol != PROTOCOL {
            return Err(ProgramError::Protocol {
                known: program.greeting.protocol,
                program: program.name.clone(),
            });
        }
        Ok(program)
    }

    /// Gives it balls at these places over a terrain; `holds`: with ground held within 0.3 m below who stood, as ours.
    ///
    /// # Errors
    /// [`ProgramError`].
    pub fn on(
        mut self,
        terrain: &Terrain,
        places: &[DVec3],
        holds: bool,
    ) -> Result<Self, ProgramError> {
        let settings = MoveSettings::default();
        self.places = places.iter().map(|place| place.as_vec3()).collect();
        let world = World {
            radius: RADIUS as f32,
            seconds: SECONDS,
            walkable: settings.walkable as f32,
            snap: if holds { settings.snap as f32 } else { 0.0 },
            vertices: terrain.vertices.iter().map(Vec3::to_array).collect(),
            triangles: &terrain.triangles,
            places: self.places.iter().map(Vec3::to_array).collect(),
        };
        let ready: Ready = self.ask(&world)?;
        if ready.balls != places.len() {
            return Err(self.no_answer(
                &format!("{{\"balls\":{}}}", ready.balls),
                format!("{} balls were given", places.len()),
            ));
        }
        Ok(self)
    }

    /// What it says that it is, and how it was built.
    pub fn about(&self) -> String {
        format!("{}, {} profile", self.greeting.name, self.greeting.profile)
    }

    fn ask<T: DeserializeOwned>(&mut self, message: &impl Serialize) -> Result<T, ProgramError> {
        let message = serde_json::to_string(message).map_err(|error| self.ended(&error))?;
        // If nobody takes it any more, hearing says why.
        let _ = self.asks.send(message + "\n");
        self.hear(ANSWERS)
    }

    fn hear<T: DeserializeOwned>(&mut self, wait: Duration) -> Result<T, ProgramError> {
        let line = match self.answers.recv_timeout(wait) {
            Ok(Ok(line)) => line,
            Ok(Err(error)) => return Err(self.ended(&error)),
            Err(RecvTimeoutError::Disconnected) => return Err(self.ended(&"no more is read")),
            Err(RecvTimeoutError::Timeout) => {
                return Err(ProgramError::Silent {
                    program: self.name.clone(),
                    seconds: wait.as_secs_f64(),
                });
            }
        };
        if let Ok(Refusal { error }) = serde_json::from_str(&line) {
            return Err(ProgramError::Refused {
                program: self.name.clone(),
                reason: error,
            });
        }
        serde_json::from_str(&line).map_err(|error| self.no_answer(&line, error.to_string()))
    }

    fn no_answer(&self, said: &str, reason: String) -> ProgramError {
        ProgramError::Answer {
            program: self.name.clone(),
            said: said.trim_end().chars().take(80).collect(),
            reason,
        }
    }

    /// It is gone: its exit status where it has one soon, else what was seen of it.
    fn ended(&mut self, seen: &impl ToString) -> ProgramError {
        let mut status = None;
        for _ in 0..20 {
            status = self.child.as_mut().and_then(|child| child.try_wait().ok()?);
            if status.is_some() || self.child.is_none() {
                break;
            }
            thread::sleep(ENDS / 20);
        }
        ProgramError::Ended {
            program: self.name.clone(),
            status: status.map_or_else(|| seen.to_string(), |status| status.to_string()),
        }
    }
}

/// Reads its greeting, and then says one line and reads one line, until nobody asks.
fn speak(
    mut output: impl BufRead,
    mut input: impl Write,
    asked: &Receiver<String>,
    said: &Sender<io::Result<String>>,
) {
    loop {
        let mut line = String::new();
        let read = output.by_ref().take(LINE).read_line(&mut line);
        let line = read.and_then(|_| match line.ends_with('\n') {
            true => Ok(line),
            false => Err(io::ErrorKind::UnexpectedEof.into()),
        });
        let over = line.is_err();
        if said.send(line).is_err() || over {
            return;
        }
        let Ok(message) = asked.recv() else {
            return;
        };
        // Who does not listen any more may have said why: that is read next.
        let _ = input
            .write_all(message.as_bytes())
            .and_then(|()| input.flush());
    }
}

impl Walkers for Program {
    fn step(&mut self, wishes: &[DVec3], stands: &mut [bool]) -> Result<f64, ProgramError> {
        let moved: Moved = self.ask(&Step {
            wishes: wishes.iter().map(DVec3::to_array).collect(),
        })?;
        let (places, balls) = (&moved.places, stands.len());
        let wrong = if places.len() != balls || moved.stands.len() != balls {
            Some(format!("{balls} balls have places and stand or not"))
        } else if !places.iter().flatten().all(|part| part.is_finite()) {
            Some("places are finite".into())
        } else if !(moved.ns.is_finite() && moved.ns >= 0.0) {
            Some("a time is finite and not negative".into())
        } else {
            None
        };
        if let Some(reason) = wrong {
            let said = format!(
                "{} places, {} that stand or not, {} ns",
                places.len(),
                moved.stands.len(),
                moved.ns
            );
            return Err(self.no_answer(&said, reason));
        }
        self.places = moved.places.into_iter().map(Vec3::from_array).collect();
        stands.copy_from_slice(&moved.stands);
        Ok(moved.ns)
    }

    fn center(&self, ball: usize) -> DVec3 {
        self.places[ball].as_dvec3()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            // Nothing that it has is kept; it may be gone already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::walkers::{Walked, places, walk};
    use super::*;
    use serde_json::{Value, json};

    const GREETING: &str = r#"{"protocol":1,"name":"nobody","profile":"dev"}"#;

    /// A program without a process: greets so, and answers each message by a line until it has none.
    fn fake(
        greeting: &'static str,
        mut answer: impl FnMut(Value) -> Option<String> + Send + 'static,
    ) -> Result<Program, ProgramError> {
        let (heard, input) = io::pipe().unwrap();
        let (output, mut says) = io::pipe().unwrap();
        thread::spawn(move || {
            let _ = writeln!(says, "{greeting}");
            for line in BufReader::new(heard).lines() {
                let Some(said) = answer(serde_json::from_str(&line.unwrap()).unwrap()) else {
                    return;
                };
                // Who asked may have had enough.
                let _ = writeln!(says, "{said}");
            }
        });
        let wait = Duration::from_secs(20);
        Program::greeted("fake".into(), BufReader::new(output), input, None, wait)
    }

    /// Balls that go where they wish to, as if there was no ground, or nowhere, and say that they stand or not.
    fn walker(goes: bool, stands: bool) -> Result<Program, ProgramError> {
        let mut places: Vec<[f64; 3]> = Vec::new();
        fake(GREETING, move |message| {
            let of = |name: &str| serde_json::from_value(message[name].clone());
            if message["wishes"].is_null() {
                assert_eq!(message["triangles"].as_array().unwrap().len(), 20_000);
                places = of("places").unwrap();
                return Some(json!({ "balls": places.len() }).to_string());
            }
            let wishes: Vec<[f64; 3]> = of("wishes").unwrap();
            for (place, wish) in places.iter_mut().zip(wishes).filter(|_| goes) {
                *place = (DVec3::from_array(*place) + DVec3::from_array(wish)).to_array();
            }
            let stands = vec![stands; places.len()];
            let ns = 250 * places.len();
            Some(json!({ "ns": ns, "places": places, "stands": stands }).to_string())
        })
    }

    fn walked(program: Result<Program, ProgramError>) -> Result<Walked, ProgramError> {
        let terrain = Terrain::hills();
        let from = places(&terrain, 20, 3);
        let mut program = program?.on(&terrain, &from, true)?;
        walk(&terrain, &from, 40, &mut [&mut program]).remove(0)
    }

    #[test]
    fn who_goes_through_the_ground_is_lost_and_who_stays_is_still() {
        let through = walked(walker(true, false)).unwrap();
        assert_eq!((through.lost, through.airborne), (20, 1.0));
        // They are out of reach of the surface before their steps count.
        assert!(through.depth == 0.0 && through.gaps.is_empty());
        // As it says itself, not as it is waited for.
        assert_eq!(through.ns, 250.0);
        let stays = walked(walker(false, true)).unwrap();
        assert_eq!((stays.lost, stays.airborne, stays.still), (0, 0.0, 1.0));
        assert_eq!(stays.depth, 0.0);
        // They hang where they were put, out of reach of what is below them.
        assert!(stays.gaps.is_empty());
    }

    #[test]
    fn wrong_answers_say_what_is_wrong() {
        let said = |world: &'static str, step: &'static str| {
            let answers = move |message: Value| {
                let said = if message["wishes"].is_null() {
                    world
                } else {
                    step
                };
                (!said.is_empty()).then(|| said.to_owned())
            };
            walked(fake(GREETING, answers)).err().unwrap()
        };
        let ready = r#"{"balls":20}"#;
        for (world, step, part) in [
            ("hello", "", "hello"),
            (r#"{"balls":19}"#, "", "20 balls were given"),
            (r#"{"error":"no mesh"}"#, "", "refuses: no mesh"),
            ("", "", "ended without an answer"),
            (ready, "", "ended without an answer"),
            (ready, "{}", "ns"),
            (ready, r#"{"ns":1,"places":[],"stands":[]}"#, "20 balls"),
        ] {
            let error = said(world, step).to_string();
            assert!(
                error.starts_with("fake") && error.contains(part),
                "{part}: {error}"
            );
        }
        // Twenty places of which one is beyond f32, and a time that cannot be.
        let twenty = |place: &str, ns: &str| {
            let places = vec![place; 20].join(",");
            let stands = vec!["true"; 20].join(",");
            format!("{{\"ns\":{ns},\"places\":[{places}],\"stands\":[{stands}]}}")
        };
        for (place, ns, part) in [("[0,1e39,0]", "1", "finite"), ("[0,0,0]", "-1", "negative")] {
            let step = twenty(place, ns);
            let answers = move |message: Value| {
                let world = message["wishes"].is_null();
                Some(if world { ready.into() } else { step.clone() })
            };
            let error = walked(fake(GREETING, answers)).err().unwrap().to_string();
            assert!(error.contains(part), "{part}: {error}");
        }
    }

    #[test]
    fn who_knows_other_messages_is_not_asked() {
        let greeting = r#"{"protocol":2,"name":"new","profile":"dev"}"#;
        let error = fake(greeting, |_| panic!("asked")).err().unwrap();
        assert!(matches!(error, ProgramError::Protocol { known: 2, .. }));
    }

    #[test]
    fn the_others_walk_on_when_one_fails() {
        let mut steps = 0;
        let fails = fake(GREETING, move |message| {
            if message["wishes"].is_null() {
                return Some(r#"{"balls":5}"#.into());
            }
            steps += 1;
            let places = vec![[0.0, 50.0, 0.0]; 5];
            let moved = json!({ "ns": 1, "places": places, "stands": vec![false; 5] });
            (steps < 35).then(|| moved.to_string())
        });
        let terrain = Terrain::hills();
        let from = places(&terrain, 5, 3);
        let mut fails = fails.unwrap().on(&terrain, &from, false).unwrap();
        let mut stays = walker(false, true).unwrap();
        stays = stays.on(&terrain, &from, false).unwrap();
        let walked = walk(&terrain, &from, 10, &mut [&mut fails, &mut stays]);
        assert!(matches!(walked[0], Err(ProgramError::Ended { .. })));
        assert!(walked[1].as_ref().is_ok_and(|walked| walked.still == 1.0));
    }

    #[cfg(unix)]
    #[test]
    fn programs_that_are_something_else_are_named() {
        let start = |name: &str, wait| {
            let wait = Duration::from_millis(wait);
            Program::start_within(Path::new(name), wait).err().unwrap()
        };
        let missing = start("no/such/program", 1);
        assert!(matches!(missing, ProgramError::Start { .. }), "{missing}");
        let silent = start("cat", 50);
        assert!(matches!(silent, ProgramError::Silent { .. }), "{silent}");
        // These end by themselves, however long the machine takes to start them.
        let other = start("echo", 60_000);
        assert!(matches!(other, ProgramError::Answer { .. }), "{other}");
        let ended = start("false", 60_000).to_string();
        assert!(ended.contains("exit status: 1"), "{ended}");
    }
}
