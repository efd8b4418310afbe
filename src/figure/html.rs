//! Reports: one self-contained HTML page that can be mailed.

use std::fmt::Write;

use base64::Engine;

/// Text made safe between HTML or SVG tags and in attributes.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

/// Rows of a table from which on it scrolls by itself.
const LONG: usize = 60;

/// A page in the making: headings, paragraphs, tables, pictures, in the order they are added.
#[derive(Debug, Clone)]
pub struct Page {
    /// The page so far, from its first byte on: pictures make it many megabytes, which are not copied again.
    html: String,
}

const STYLE: &str = "\
body{font:16px/1.45 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#222}\
h1{font-weight:500}h2{font-weight:500;margin-top:2.5rem}img{max-width:100%;border:1px solid #ddd}\
table{border-collapse:collapse;font-size:14px;font-variant-numeric:tabular-nums}\
th,td{padding:.2rem .6rem;border-bottom:1px solid #e4e4e4;text-align:left}\
th{position:sticky;top:0;background:#fff}tr.out \
td{background:#fff3e0}figure{margin:2rem 0}\
figcaption{font-size:15px;color:#444;max-width:60rem}.scroll{max-height:36rem;overflow:auto}\
@media print{.scroll{max-height:none}}";

impl Page {
    /// An empty page.
    pub fn new(title: &str) -> Self {
        let title = escape(title);
        let html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta \
             charset=\"utf-8\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
        );
        Self { html }
    }

    /// Makes room for pictures of so many bytes: the page is not copied as it grows.
    pub fn reserve(&mut self, png_bytes: usize) {
        self.html.reserve(png_bytes.div_ceil(3) * 4);
    }

    /// A section's heading.
    pub fn heading(&mut self, text: &str) {
        let _ = writeln!(self.html, "<h2>{}</h2>", escape(text));
    }

    /// A section's heading, and a name that links go to.
    pub fn anchored_heading(&mut self, name: &str, text: &str) {
        let _ = writeln!(self.html, "<h2 id=\"{}\">{}</h2>", escape(name), escape(text));
    }

    /// Links, each a place and words, one after the other.
    pub fn links(&mut self, before: &str, links: &[(String, String)]) {
        let link = |(to, words): &(String, String)| format!("<a href=\"{}\">{}</a>", escape(to), escape(words));
        let all: Vec<String> = links.iter().map(link).collect();
        let _ = writeln!(self.html, "<p>{} {}</p>", escape(before), all.join(" \u{b7} "));
    }

    /// A PNG file's bytes as a picture with its number and words below.
    pub fn figure(&mut self, png: &[u8], number: &str, caption: &str) {
        let (number, caption) = (escape(number), escape(caption));
        self.html.push_str("<figure>");
        self.image(png, &number);
        let _ = writeln!(self.html, "<figcaption><b>{number}.</b> {caption}</figcaption></figure>");
    }

    /// Plain words.
    pub fn paragraph(&mut self, text: &str) {
        let _ = writeln!(self.html, "<p>{}</p>", escape(text));
    }

    /// Plain words, a point each; nothing where there are none.
    pub fn list(&mut self, items: &[String]) {
        if !items.is_empty() {
            let items: String = items.iter().map(|i| format!("<li>{}</li>\n", escape(i))).collect();
            let _ = writeln!(self.html, "<ul>\n{items}</ul>");
        }
    }

    /// A table; rows for which `marked` holds stand out. A long one scrolls by itself.
    pub fn table(&mut self, header: &[&str], rows: &[Vec<String>], marked: impl Fn(usize) -> bool) {
        let cells = |tag: &str, row: &mut dyn Iterator<Item = &str>| -> String {
            row.map(|c| format!("<{tag}>{}</{tag}>", escape(c))).collect()
        };
        let _ = writeln!(
            self.html,
            "<div{}><table>\n<thead><tr>{}</tr></thead>\n<tbody>",
            if rows.len() > LONG { " class=\"scroll\"" } else { "" },
            cells("th", &mut header.iter().copied())
        );
        for (at, row) in rows.iter().enumerate() {
            let class = if marked(at) { " class=\"out\"" } else { "" };
            let _ = writeln!(self.html, "<tr{class}>{}</tr>", cells("td", &mut row.iter().map(String::as_str)));
        }
        let _ = writeln!(self.html, "</tbody></table></div>");
    }

    /// A PNG file's bytes as a picture.
    pub fn png(&mut self, png: &[u8], alt: &str) {
        self.html.push_str("<p>");
        self.image(png, &escape(alt));
        self.html.push_str("</p>\n");
    }

    /// A PNG file's bytes, in place; `alt` is escaped.
    fn image(&mut self, png: &[u8], alt: &str) {
        let _ = write!(self.html, "<img alt=\"{alt}\" src=\"data:image/png;base64,");
        base64::engine::general_purpose::STANDARD.encode_string(png, &mut self.html);
        self.html.push_str("\">");
    }

    /// The whole page.
    pub fn finish(mut self) -> String {
        self.html.push_str("</body>\n</html>\n");
        self.html
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_not_markup() {
        let mut page = Page::new("a <b> & c");
        page.table(&["file"], &[vec!["<script>\"x\"</script>.png".into()]], |_| true);
        let html = page.finish();
        assert!(!html.contains("<script>") && html.contains("&lt;script&gt;") && html.contains("a &lt;b&gt; &amp; c"));
    }
}
