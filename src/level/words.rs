//! What is said of a level while it is played.

use serde::Deserialize;

/// What is said of a level: each as it stands in a sentence. What a file leaves out is what the mountain says.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Words {
    /// What is to be done, before how many of how many.
    pub task: String,
    /// What is to be done once the gate is open.
    pub leave: String,
    /// What the player does at one of them, before its name.
    pub verb: String,
    /// What so many of them do, in the sum at the end.
    pub sum: String,
    /// The headline of a game that was won.
    pub won: String,
    /// The headline of one that was lost.
    pub lost: String,
    /// Why, where the time was over.
    pub late: String,
    /// What is said while the game rests.
    pub rests: String,
    /// The way back from there.
    pub back: String,
}

impl Default for Words {
    /// Those of the mountain.
    fn default() -> Self {
        Self {
            task: "Light the beacons".into(),
            leave: "The gate is open".into(),
            verb: "light".into(),
            sum: "beacons burn".into(),
            won: "All beacons burn".into(),
            lost: "The south wall stays dark".into(),
            late: "The night is over.".into(),
            rests: "The mountain waits.".into(),
            back: "Back to the mountain".into(),
        }
    }
}
