//! Text for other programs: the system's clipboard.

use bevy::ecs::resource::Resource;

/// The clipboard; kept, because X11 asks the program that copied.
#[derive(Resource, Default)]
pub struct Clip(Option<std::sync::Mutex<arboard::Clipboard>>);

impl Clip {
    /// Copies a text.
    ///
    /// # Errors
    /// What the system says, for instance where there is no display.
    pub fn copy(&mut self, text: &str) -> Result<(), String> {
        if self.0.is_none() {
            let clipboard = arboard::Clipboard::new().map_err(|error| error.to_string())?;
            self.0 = Some(clipboard.into());
        }
        let clipboard = self.0.as_mut().expect("made above");
        let clipboard = clipboard.get_mut().map_err(|error| error.to_string())?;
        clipboard
            .set_text(text.to_owned())
            .map_err(|error| error.to_string())
    }
}
