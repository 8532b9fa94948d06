//! From a line to its words.

use thiserror::Error;

/// A word of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// Without its quotation marks.
    pub text: String,
    /// Byte of the line at which it begins.
    pub at: usize,
}

/// A quotation mark without its partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("column {column}: the quotation mark {mark} is not closed")]
pub struct Unclosed {
    /// The mark.
    pub mark: char,
    /// Where it stands, in characters from 1 on.
    pub column: usize,
}

/// The words of a line: parts between white space. What stands between two `"` or two `'` is of one word, white space
/// and all; in the former `\"` and `\\` are a mark and a backslash. A word that begins with `#` ends the line.
///
/// # Errors
/// [`Unclosed`].
pub fn words(line: &str) -> Result<Vec<Word>, Unclosed> {
    let (words, open) = split(line);
    open.map_or(Ok(words), Err)
}

/// The words of a line that is still being typed, the last of which may lack a quotation mark; and whether the last one
/// is being typed: nothing stands after it.
#[must_use]
pub fn words_so_far(line: &str) -> (Vec<Word>, bool) {
    let (words, open) = split(line);
    let typed = open.is_some() || line.chars().next_back().is_some_and(|c| !c.is_whitespace());
    (words, typed)
}

fn split(line: &str) -> (Vec<Word>, Option<Unclosed>) {
    let mut words = Vec::new();
    let mut word: Option<Word> = None;
    // The mark that is open, and its column.
    let mut open: Option<(char, usize)> = None;
    let mut characters = line.char_indices().enumerate().peekable();
    while let Some((column, (at, c))) = characters.next() {
        if let Some((mark, _)) = open {
            let text = &mut word.get_or_insert_with(|| empty(at)).text;
            if c == mark {
                open = None;
            } else if mark == '"'
                && c == '\\'
                && let Some(&(_, (_, next))) = characters.peek()
                && matches!(next, '"' | '\\')
            {
                characters.next();
                text.push(next);
            } else {
                text.push(c);
            }
        } else if c.is_whitespace() {
            words.extend(word.take());
        } else if c == '#' && word.is_none() {
            break;
        } else if matches!(c, '"' | '\'') {
            open = Some((c, column + 1));
            word.get_or_insert_with(|| empty(at));
        } else {
            word.get_or_insert_with(|| empty(at)).text.push(c);
        }
    }
    words.extend(word);
    let open = open.map(|(mark, column)| Unclosed { mark, column });
    (words, open)
}

const fn empty(at: usize) -> Word {
    Word {
        text: String::new(),
        at,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(line: &str) -> Vec<String> {
        words(line)
            .unwrap()
            .into_iter()
            .map(|word| word.text)
            .collect()
    }

    #[test]
    fn words_are_parted_by_white_space_and_held_by_marks() {
        assert_eq!(texts("  set  Sky.dust\t20 "), ["set", "Sky.dust", "20"]);
        assert_eq!(texts(r#"a "b c"d 'e "f"'"#), ["a", "b cd", r#"e "f""#]);
        assert_eq!(texts(r#""a \"b\" \\ \n""#), [r#"a "b" \ \n"#]);
        assert_eq!(texts("''"), [""]);
        assert_eq!(texts(""), [""; 0]);
        assert_eq!(words("é  ü").unwrap()[1].at, 4);
    }

    #[test]
    fn a_number_sign_begins_a_comment_only_where_a_word_would() {
        assert_eq!(texts("get a#b # the rest"), ["get", "a#b"]);
        assert_eq!(texts("# nothing \" at all"), [""; 0]);
    }

    #[test]
    fn an_open_mark_is_named_with_its_column() {
        let error = words("sét \"a").unwrap_err();
        assert_eq!((error.mark, error.column), ('"', 5));
        assert_eq!(words("'a\"").unwrap_err().mark, '\'');
    }

    #[test]
    fn a_line_that_is_being_typed_knows_its_last_word() {
        let last = |line| {
            let (words, typed) = words_so_far(line);
            (words.last().map(|word| word.text.clone()), typed)
        };
        assert_eq!(last("set Sk"), (Some("Sk".to_owned()), true));
        assert_eq!(last("set "), (Some("set".to_owned()), false));
        assert_eq!(last("set \"a "), (Some("a ".to_owned()), true));
        assert_eq!(last(""), (None, false));
    }
}
