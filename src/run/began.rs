//! When the process began, which is earlier than `main`.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

static BEGAN: OnceLock<Began> = OnceLock::new();

/// Linux counts the start of a process in hundredths of a second (`USER_HZ`), on every processor that Bevy has
/// Vulkan for.
const TICKS_A_SECOND: u64 = 100;

/// From the start of a process to `main` it takes this at most. What says otherwise counts by another clock.
const LOADED_WITHIN: Duration = Duration::from_secs(60);

/// The beginning of this process.
#[derive(Clone, Copy, Debug)]
pub struct Began {
    /// When.
    pub at: Instant,
    /// By what it is known.
    pub by: Clock,
}

/// What knows when a process began.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// The system: the start of the process, to a hundredth of a second.
    Process,
    /// The first line of `main`.
    Main,
}

/// Notes the time. The first line of `main`; whoever does not call it is taken to begin with [`began`].
pub fn note() {
    let _ = BEGAN.set(find());
}

/// When this process began.
pub fn began() -> Began {
    *BEGAN.get_or_init(find)
}

fn find() -> Began {
    let now = Instant::now();
    let read = |file| std::fs::read_to_string(file).ok();
    let age = read("/proc/self/stat")
        .zip(read("/proc/uptime"))
        .and_then(|(stat, uptime)| age(&stat, &uptime))
        .filter(|age| *age < LOADED_WITHIN);
    match age.and_then(|age| now.checked_sub(age)) {
        Some(at) => Began {
            at,
            by: Clock::Process,
        },
        None => Began {
            at: now,
            by: Clock::Main,
        },
    }
}

/// How old the process is of which the kernel says `stat`, when the system has been up for as long as `uptime` says.
fn age(stat: &str, uptime: &str) -> Option<Duration> {
    // The second field is the name in brackets, which may hold anything; the start is the 22nd (proc_pid_stat(5)).
    let (_, fields) = stat.rsplit_once(')')?;
    let start: u64 = fields.split_whitespace().nth(22 - 3)?.parse().ok()?;
    let (seconds, hundredths) = uptime.split_whitespace().next()?.split_once('.')?;
    let hundredths: u64 = hundredths.get(..2)?.parse().ok()?;
    let up = seconds.parse::<u64>().ok()?.checked_mul(TICKS_A_SECOND)? + hundredths;
    // The two are cut to hundredths, each by itself.
    let ticks = up.saturating_sub(start);
    Some(Duration::from_millis(ticks * (1000 / TICKS_A_SECOND)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_age_is_uptime_less_start() {
        // Fields 3 to 22 behind a name that looks like fields.
        let stat = "12 (a ) 7 b) S 1 1 1 0 -1 4194304 90 0 0 0 3 1 0 0 20 0 1 0 12345 1000 5";
        assert_eq!(age(stat, "125.95 60.00"), Some(Duration::from_millis(2500)));
        assert_eq!(age(stat, "123.44 60.00"), Some(Duration::ZERO));
        for (stat, uptime) in [
            ("", "1.00 1.00"),
            ("1 (a) S 1", "1.00"),
            (stat, ""),
            (stat, "x.y"),
        ] {
            assert_eq!(age(stat, uptime), None, "{stat} {uptime}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_began_before_now_by_the_system() {
        let began = find();
        assert_eq!(began.by, Clock::Process);
        // A test of one function: it has just begun.
        assert!(began.at.elapsed() < LOADED_WITHIN);
    }
}
