//! A page of figures: one HTML file with everything in it. No script, nothing from elsewhere; light or dark as the
//! reader's system is.

use std::fmt::Write;

/// Colours by name, so that dark is one block.
const STYLE: &str = "\
:root{color-scheme:light dark;--ground:#fff;--text:#1b1f24;--weak:#5a6470;--line:#d8dee4;--card:#f6f8fa;\
--good:#0072b2;--bad:#c4480a}\
@media(prefers-color-scheme:dark){:root{--ground:#14171b;--text:#e6e9ed;--weak:#98a2ad;--line:#343b43;--card:#1c2127;\
--good:#56b4e9;--bad:#f0913d}}\
body{background:var(--ground);color:var(--text);font:16px/1.5 sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem}\
h1,h2{line-height:1.2}h2{margin-top:3rem;border-top:1px solid var(--line);padding-top:1rem}\
a{color:var(--good)}.weak{color:var(--weak);font-size:.9rem}\
nav{columns:16rem;font-size:.95rem}nav a{display:block}\
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.9rem;width:100%}\
th,td{text-align:left;vertical-align:top;padding:.25rem .6rem .25rem 0;border-bottom:1px solid var(--line)}\
td.number{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}\
code{font-size:.8rem;color:var(--weak);overflow-wrap:anywhere}\
figure{margin:1.5rem 0}figure>svg{background:#fff;border-radius:6px;max-width:100%;height:auto}\
figcaption{color:var(--weak);font-size:.9rem}\
svg.bar{display:block;width:160px;height:14px}svg.bar .field{fill:var(--card)}svg.bar .good{fill:var(--good)}\
svg.bar .bad{fill:var(--bad)}svg.bar .end{stroke:var(--text);stroke-width:1.5}";

/// A page that is being written.
#[derive(Debug)]
pub struct Page {
    title: String,
    contents: String,
    body: String,
}

impl Page {
    /// An empty page. `words` stand below its title.
    #[must_use]
    pub fn new(title: &str, words: &str) -> Self {
        Self {
            title: title.to_owned(),
            contents: String::new(),
            body: format!("<p>{}</p>\n", escaped(words)),
        }
    }

    /// A heading with an anchor of its name, listed at the top.
    pub fn section(&mut self, name: &str, heading: &str) {
        let (name, heading) = (escaped(name), escaped(heading));
        self.contents += &format!("<a href=\"#{name}\">{heading}</a>\n");
        self.html(format_args!("<h2 id=\"{name}\">{heading}</h2>\n"));
    }

    /// Words.
    pub fn words(&mut self, words: &str) {
        self.html(format_args!("<p>{}</p>\n", escaped(words)));
    }

    /// Words that matter less: device, date.
    pub fn weak(&mut self, words: &str) {
        self.html(format_args!("<p class=\"weak\">{}</p>\n", escaped(words)));
    }

    /// A chart, which is SVG text, and what it shows.
    pub fn figure(&mut self, svg: &str, caption: &str) {
        // A page has no declaration of XML within it.
        let svg = svg.find("<svg").map_or(svg, |at| &svg[at..]);
        self.html(format_args!(
            "<figure>\n{}\n<figcaption>{}</figcaption>\n</figure>\n",
            svg.trim_end(),
            escaped(caption)
        ));
    }

    /// A list of words.
    pub fn list<'a>(&mut self, items: impl IntoIterator<Item = &'a str>) {
        let items: String = items
            .into_iter()
            .map(|item| format!("<li>{}</li>\n", escaped(item)))
            .collect();
        if !items.is_empty() {
            self.html(format_args!("<ul>\n{items}</ul>\n"));
        }
    }

    /// A table: headings, and rows whose cells are HTML already.
    pub fn table(&mut self, headings: &[&str], rows: &[Vec<String>]) {
        let headings: String = headings
            .iter()
            .map(|heading| format!("<th>{}</th>", escaped(heading)))
            .collect();
        let rows: String = rows
            .iter()
            .map(|cells| format!("<tr>{}</tr>\n", cells.concat()))
            .collect();
        self.html(format_args!(
            "<div class=\"wide\"><table>\n<tr>{headings}</tr>\n{rows}</table></div>\n"
        ));
    }

    fn html(&mut self, text: std::fmt::Arguments<'_>) {
        self.body
            .write_fmt(text)
            .expect("a String takes everything that is written");
    }

    /// The whole file.
    #[must_use]
    pub fn finish(self) -> String {
        let title = escaped(&self.title);
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n\
             <link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
             <nav>\n{}</nav>\n{}</body>\n</html>\n",
            self.contents, self.body
        )
    }
}

/// Text within HTML.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_holds_what_was_put_in_and_lists_its_sections() {
        let mut page = Page::new("A & B", "words");
        page.section("one", "The <first>");
        page.figure(
            "<?xml version=\"1.0\"?>\n<svg></svg>\n",
            "what it \"shows\"",
        );
        page.table(&["a"], &[vec!["<td>1</td>".to_owned()]]);
        page.list(["x < y"]);
        page.list([]);
        let text = page.finish();
        for part in [
            "<title>A &amp; B</title>",
            "<a href=\"#one\">The &lt;first&gt;</a>",
            "<figure>\n<svg></svg>\n<figcaption>what it &quot;shows&quot;</figcaption>",
            "<tr><th>a</th></tr>\n<tr><td>1</td></tr>",
            "<li>x &lt; y</li>",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(!text.contains("<script") && !text.contains("<?xml"));
        assert_eq!(text.matches("<ul>").count(), 1);
    }
}
