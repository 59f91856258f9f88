//! Text and numbers in HTML: whatever did not come from this program is escaped here.

use std::fmt::{self, Display, Write};

/// A value as text that HTML shows as it is, between tags and inside double-quoted attributes.
///
/// ```
/// use blur_cli::report::html::Text;
/// assert_eq!(Text("a<b> & \"c\" 'd'").to_string(), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Text<T>(pub T);

impl<T: Display> Display for Text<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Escaping(f), "{}", self.0)
    }
}

struct Escaping<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl Write for Escaping<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            match c {
                '&' => self.0.write_str("&amp;")?,
                '<' => self.0.write_str("&lt;")?,
                '>' => self.0.write_str("&gt;")?,
                '"' => self.0.write_str("&quot;")?,
                '\'' => self.0.write_str("&#39;")?,
                // Control characters have no place in HTML, and those that turn the direction of writing could make a
                // name look like another one.
                c if c.is_control() && !matches!(c, '\n' | '\t') => self.0.write_char('\u{fffd}')?,
                '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => self.0.write_char('\u{fffd}')?,
                c => self.0.write_char(c)?,
            }
        }
        Ok(())
    }
}

/// A field of the record for people, with the number itself in the attribute `value`.
#[derive(Debug, Clone, Copy)]
pub struct Data<'a> {
    /// Name of the field in the JSON record.
    pub field: &'static str,
    /// The number.
    pub value: f64,
    /// The number as it is shown.
    pub shown: &'a str,
}

impl Display for Data<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, value, shown } = self;
        write!(f, "<data data-field=\"{field}\" value=\"{value}\">{}</data>", Text(shown))
    }
}

/// One figure or table of a section: a title, its content as HTML and a caption that says how to read it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Heading.
    pub title: &'static str,
    /// HTML.
    pub content: String,
    /// HTML below the content.
    pub caption: String,
    /// Whether it takes the whole width.
    pub is_wide: bool,
}

impl Figure {
    /// What stands in the place of a figure that does not apply, and why it does not.
    pub fn absent(title: &'static str, reason: impl Display) -> Self {
        Self {
            title,
            content: format!("<p class=\"absent\">{}</p>", Text(reason)),
            caption: String::new(),
            is_wide: false,
        }
    }
}

impl Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let class = if self.is_wide { " class=\"wide\"" } else { "" };
        write!(f, "<figure{class}><h3>{}</h3>{}", self.title, self.content)?;
        if !self.caption.is_empty() {
            write!(f, "<figcaption>{}</figcaption>", self.caption)?;
        }
        f.write_str("</figure>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_control_characters_cannot_break_out() {
        let name = "</script><img src=x onerror=alert(1)>\u{202e}gnp.\0";
        let shown = Text(name).to_string();
        assert!(!shown.contains(['<', '>', '\0', '\u{202e}']), "{shown}");
        assert_eq!(Text(1.5).to_string(), "1.5");
    }
}
