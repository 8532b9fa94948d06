//! What was typed before.

/// Most lines that are kept.
const MOST: usize = 500;

/// The lines that were entered, and which of them is shown in place of what is being typed.
#[derive(Clone, Debug, Default)]
pub struct History {
    lines: Vec<String>,
    /// Steps back from the line that is being typed.
    back: usize,
    /// What was being typed when the first step back was taken.
    typed: String,
}

impl History {
    /// Keeps an entered line; not where it is empty or the one before.
    pub fn push(&mut self, line: &str) {
        self.back = 0;
        self.typed.clear();
        let line = line.trim();
        if line.is_empty() || self.lines.last().is_some_and(|last| last == line) {
            return;
        }
        if self.lines.len() == MOST {
            self.lines.remove(0);
        }
        self.lines.push(line.to_owned());
    }

    /// The line before the one that is shown, which is `typed` at first; `None` where there is none.
    pub fn back(&mut self, typed: &str) -> Option<&str> {
        if self.back == self.lines.len() {
            return None;
        }
        if self.back == 0 {
            typed.clone_into(&mut self.typed);
        }
        self.back += 1;
        Some(&self.lines[self.lines.len() - self.back])
    }

    /// The line after the one that is shown: at last what was being typed. `None` where that is shown.
    pub fn forward(&mut self) -> Option<&str> {
        self.back = self.back.checked_sub(1)?;
        Some(match self.back {
            0 => &self.typed,
            back => &self.lines[self.lines.len() - back],
        })
    }

    /// All lines, the oldest first.
    #[must_use]
    pub fn lines(&self) -> &[String] {
        &self.lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_back_and_so_does_what_was_being_typed() {
        let mut history = History::default();
        assert_eq!(history.back("x"), None);
        for line in ["a", " b ", "b", "", "c"] {
            history.push(line);
        }
        assert_eq!(history.lines(), ["a", "b", "c"]);
        assert_eq!(history.back("new"), Some("c"));
        assert_eq!(history.back("c"), Some("b"));
        assert_eq!(history.back("b"), Some("a"));
        assert_eq!(history.back("a"), None);
        assert_eq!(history.forward(), Some("b"));
        assert_eq!(history.forward(), Some("c"));
        assert_eq!(history.forward(), Some("new"));
        assert_eq!(history.forward(), None);
    }

    #[test]
    fn old_lines_are_forgotten() {
        let mut history = History::default();
        for k in 0..2 * MOST {
            history.push(&k.to_string());
        }
        assert_eq!(history.lines().len(), MOST);
        assert_eq!(history.lines()[0], MOST.to_string());
    }
}
