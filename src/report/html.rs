//! A report as HTML text.

use std::fmt::Write as _;

use super::table::{Cell, Row, RowKind, Table};
use super::{Block, Plate, Report, Section};
use crate::draw::escape;

const STYLE: &str = include_str!("style.css");
/// Tables of more columns are set closer.
const WIDE: usize = 9;
const SCRIPT: &str = include_str!("script.js");

pub(super) fn page(report: &Report) -> String {
    let title = escape(&report.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <header>\n<h1>{title}</h1>\n<p class=\"question\">{}</p>\n",
        inline(&report.question)
    );
    if let Some(answer) = &report.answer {
        let verdict = match report.as_expected {
            None => "",
            Some(true) => " expected",
            Some(false) => " unexpected",
        };
        let _ = writeln!(out, "<p class=\"answer{verdict}\">{}</p>", inline(answer));
    }
    out.push_str("</header>\n");
    contents(&report.sections, &mut out);
    let mut plates = 0;
    for (index, section) in report.sections.iter().enumerate() {
        section_into(section, index + 1, &mut plates, &mut out);
    }
    footer(report, &mut out);
    let _ = write!(
        out,
        "</main>\n<div id=\"tip\" role=\"status\" hidden></div>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    );
    out
}

fn contents(sections: &[Section], out: &mut String) {
    if sections.len() < 3 {
        return;
    }
    out.push_str("<nav>");
    for (index, section) in sections.iter().enumerate() {
        let _ = write!(out, "<a href=\"#s{}\">{}</a>", index + 1, escape(&section.title));
    }
    out.push_str("</nav>\n");
}

fn section_into(section: &Section, number: usize, plates: &mut usize, out: &mut String) {
    let title = escape(&section.title);
    let (open, close) = if section.folded { ("<details><summary>", "</summary>") } else { ("", "") };
    let _ = writeln!(out, "<section id=\"s{number}\">\n{open}<h2>{title}</h2>{close}");
    section.blocks.iter().for_each(|block| block_into(block, plates, out));
    out.push_str(if section.folded { "</details></section>\n" } else { "</section>\n" });
}

fn block_into(block: &Block, plates: &mut usize, out: &mut String) {
    match block {
        Block::Text(text) => {
            let _ = writeln!(out, "<p>{}</p>", inline(text));
        }
        Block::Lines(printed) => {
            // A browser drops the line's end that comes first: so it is not the text's.
            let _ = writeln!(out, "<pre>\n{}</pre>", escape(printed));
        }
        Block::Table(table) => table_into(table, out),
        Block::Plates(row) => {
            let _ = writeln!(out, "<div class=\"plates of{}\">", row.len().min(3));
            for plate in row {
                *plates += 1;
                plate_into(plate, *plates, out);
            }
            out.push_str("</div>\n");
        }
    }
}

fn plate_into(plate: &Plate, number: usize, out: &mut String) {
    let _ = writeln!(out, "<figure id=\"p{number}\">\n{}", plate.inline_svg);
    let (name, caption) = (escape(&plate.name), inline(&plate.caption));
    let _ = writeln!(out, "<figcaption><b>{name}.</b> {caption}</figcaption>");
    if let Some(data) = &plate.data {
        // "</script" inside JSON would end the element early; "<" as an escape means the same.
        let data = data.to_string().replace('<', "\\u003c");
        let _ = writeln!(out, "<script type=\"application/json\">{data}</script>");
    }
    out.push_str("</figure>\n");
}

fn table_into(table: &Table, out: &mut String) {
    let numeric: Vec<bool> = (0..table.heads.len()).map(|column| table.is_numeric(column)).collect();
    let class = |column: usize| if numeric[column] { " class=\"n\"" } else { "" };
    let _ = write!(
        out,
        "<div class=\"table{}\"><table>\n<caption><b>{}.</b> {}</caption>\n<thead><tr>",
        if table.heads.len() > WIDE { " wide" } else { "" },
        escape(&table.name),
        inline(&table.caption)
    );
    for (column, head) in table.heads.iter().enumerate() {
        let _ = write!(out, "<th scope=\"col\"{} tabindex=\"0\">{}</th>", class(column), escape(head));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for Row { kind, cells } in &table.rows {
        let _ = write!(out, "<tr class=\"{}\">", kind_class(*kind));
        for (column, Cell { text, value, hint }) in cells.iter().enumerate().take(numeric.len()) {
            let sort = value.map(|value| format!(" data-v=\"{value}\"")).unwrap_or_default();
            let hint = if hint.is_empty() { String::new() } else { format!(" data-hint=\"{}\"", escape(hint)) };
            // In close tables, what stands in brackets behind a number goes below it.
            let shown = match text.split_once(" (").filter(|_| value.is_some()) {
                Some((number, brackets)) => format!("{} <span>({}</span>", inline(number), inline(brackets)),
                None => inline(text),
            };
            let _ = write!(out, "<td{}{sort}{hint}>{shown}</td>", class(column));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table></div>\n");
}

fn kind_class(kind: RowKind) -> &'static str {
    match kind {
        RowKind::Ours => "ours",
        RowKind::Reference => "reference",
        RowKind::Published => "published",
    }
}

fn footer(report: &Report, out: &mut String) {
    out.push_str("<footer>\n");
    if !report.footnotes.is_empty() {
        out.push_str("<ol>\n");
        for note in &report.footnotes {
            let _ = writeln!(out, "<li>{}</li>", inline(note));
        }
        out.push_str("</ol>\n");
    }
    if !report.manifest.is_empty() {
        out.push_str("<dl>\n");
        for (what, value) in &report.manifest {
            let _ = writeln!(out, "<dt>{}</dt><dd>{}</dd>", escape(what), escape(value));
        }
        out.push_str("</dl>\n");
    }
    out.push_str("</footer>\n");
}

/// Escaped text, with what stands between backquotes set as code.
fn inline(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    // An odd backquote is a backquote.
    if parts.len().is_multiple_of(2) {
        return escape(text);
    }
    let code = |(index, part): (usize, &&str)| match index % 2 {
        0 => escape(part),
        _ => format!("<code>{}</code>", escape(part)),
    };
    parts.iter().enumerate().map(code).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_code_is_code() {
        assert_eq!(inline("a `b<c>` & `d`"), "a <code>b&lt;c&gt;</code> &amp; <code>d</code>");
        assert_eq!(inline("5 ` 6"), "5 ` 6");
    }

    #[test]
    fn what_is_printed_keeps_its_lines() {
        let page = Report::new("", "").section(Section::new("").lines("\na < `b`\n    c\n")).html();
        assert!(page.contains("<pre>\n\na &lt; `b`\n    c\n</pre>"), "{page}");
    }

    #[test]
    fn the_bar_beside_the_answer_tells_whether_it_was_expected() {
        for (is_expected, class) in
            [(None, "answer"), (Some(true), "answer expected"), (Some(false), "answer unexpected")]
        {
            let page = Report::new("", "").answer("").as_expected(is_expected).html();
            assert!(page.contains(&format!("<p class=\"{class}\">")), "{class}");
        }
        for rule in
            [".answer {", ".answer.expected { border-left-color: #009e73", ".answer.unexpected { border-left-color: #d"]
        {
            assert!(STYLE.contains(rule), "{rule}");
        }
    }

    #[test]
    fn hostile_text_stays_text() {
        let evil = "</script><script>alert(1)</script>\"'&";
        let table = Table::new(evil, &[evil]).caption(evil).row(RowKind::Ours, [Cell::from(evil).hint(evil)]);
        let figure = crate::draw::Figure::new(evil, evil).caption(evil).level(evil, 1.0).points(
            evil,
            crate::draw::Mark::Dot,
            [[0.0, 1.0]],
        );
        let section = Section::new(evil).text(evil).lines(evil).table(table).figure(&figure);
        let page = Report::new(evil, evil).answer(evil).section(section).footnote(evil).made_with(evil, evil).html();
        // One script of the page's own and one of data: nothing of what was put in.
        assert_eq!(page.matches("<script").count(), 2);
        assert_eq!(page.matches("</script").count(), 2);
        assert!(!page.contains("<script>alert"));
    }
}
