//! What the log was told, so that it is told each thing once.

/// Whether something has not been told yet; it counts as told from now on.
pub(crate) fn is_news<T: PartialEq + Clone>(told: &mut Vec<T>, found: &T) -> bool {
    let news = !told.contains(found);
    if news {
        told.push(found.clone());
    }
    news
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_is_news_once() {
        let mut told = Vec::new();
        let found = [1, 1, 2, 1, 2, 3].map(|found| is_news(&mut told, &found));
        assert_eq!(found, [true, false, true, false, false, true]);
    }
}
