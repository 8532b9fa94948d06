//! `dolomite bot` on the command line.

use std::path::PathBuf;
use std::process::Command;

use clap::Args;
use dolomite_game::bench::BenchError;
use dolomite_game::bot::record::Record;
use dolomite_game::bot::{self, BotError, Job, Played, Table};
use dolomite_game::run::GameError;
use dolomite_game::settings::paths;

/// With how many threads a recording is played again.
const THREADS: [usize; 2] = [1, 2];

/// Let a bot play a level to its end, by input alone, without a window.
#[derive(Args)]
pub struct Bot {
    /// The level: `mountain`, `city`.
    #[arg(long, default_value = "mountain")]
    level: String,
    /// The first seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many games, of this seed and those after it.
    #[arg(long, default_value_t = 1)]
    runs: u32,
    /// The report to write.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Put the last beacon out of reach: no game can be won.
    #[arg(long)]
    unreachable: bool,
    /// Seconds of the game until it is lost, 1 to 86400 [default: those of the level].
    #[arg(long, value_name = "SECONDS")]
    limit: Option<f32>,
    /// Record the first game.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Play a recording again, by one thread and by two, and compare the hashes.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["record", "json", "runs"])]
    replay: Option<PathBuf>,
    /// Threads that work on a game [default: those of the machine].
    #[arg(long)]
    threads: Option<usize>,
}

impl Bot {
    /// Plays; whether all went as it should.
    ///
    /// # Errors
    /// [`BotError`] and [`GameError`].
    pub fn run(&self) -> Result<bool, BenchError> {
        let assets = paths::assets_dir().map_err(GameError::from)?;
        let job = Job {
            level: &self.level,
            seed: self.seed,
            runs: self.runs,
            threads: self.threads,
            unreachable: self.unreachable,
            limit: self.limit,
        };
        if let Some(file) = &self.replay {
            return Ok(self.replay(file, &job, &assets)?);
        }
        let (report, first) = bot::play(&job, &assets, tell)?;
        if let (Some(path), Some(record)) = (&self.record, first) {
            record.write(path).map_err(BotError::from)?;
        }
        println!(
            "dolomite: {} of {} games won in {:.1} s",
            report.wins, report.runs, report.seconds
        );
        if let Some(path) = &self.json {
            let text = serde_json::to_string_pretty(&report).unwrap_or_default();
            std::fs::write(path, text + "\n").map_err(|source| BotError::Report {
                path: path.clone(),
                source,
            })?;
        }
        Ok(true)
    }

    /// Bevy's threads are those of a process: each number of them has its own.
    fn replay(
        &self,
        file: &PathBuf,
        job: &Job,
        assets: &std::path::Path,
    ) -> Result<bool, BotError> {
        let record = Record::read(file)?;
        if let Some(threads) = self.threads {
            let table = Table::new(
                &Job {
                    level: &record.level,
                    threads: Some(threads),
                    ..*job
                },
                assets,
            )?;
            tell(&table.replay(&record));
            return Ok(true);
        }
        let recorded = format!("{:016x}", record.hash);
        let mut same = true;
        println!("recorded   {recorded}  {} steps", record.inputs.len());
        for threads in THREADS {
            let refuse = |reason: String| BotError::Replay { threads, reason };
            let program = std::env::current_exe().map_err(|error| refuse(error.to_string()))?;
            let mut command = Command::new(program);
            command.args(["bot", "--threads", &threads.to_string(), "--replay"]);
            command.arg(file);
            if let Some(limit) = self.limit {
                command.args(["--limit", &limit.to_string()]);
            }
            if self.unreachable {
                command.arg("--unreachable");
            }
            let output = command
                .output()
                .map_err(|error| refuse(error.to_string()))?;
            let text = String::from_utf8_lossy(&output.stdout);
            let hash = text.split_whitespace().last().unwrap_or_default();
            if !output.status.success() {
                return Err(refuse(String::from_utf8_lossy(&output.stderr).into_owned()));
            }
            println!("{threads} thread(s) {hash}");
            same &= hash == recorded;
        }
        println!("{}", if same { "the same" } else { "NOT the same" });
        Ok(same)
    }
}

fn tell(game: &Played) {
    println!(
        "seed {}: {:?} after {} steps ({:.1} min), {} beacons, {} fallen, health {:.0}, {} calls, hash {}",
        game.seed,
        game.reason,
        game.steps,
        bot::minutes(game.steps),
        game.beacons,
        game.fallen,
        game.health,
        game.calls,
        game.hash
    );
}
