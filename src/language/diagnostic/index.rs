//! All codes with their explanations, on one page.

use std::fmt::Write as _;

use super::{Code, explain};

/// The index of all codes as a page of Markdown: a table, and for each code what `kiln explain` tells.
#[must_use]
pub fn errors() -> String {
    let mut page = String::from(
        "# Errors and warnings\n\n\
         <!-- Generated from src/language/diagnostic; KILN_BLESS=1 cargo test writes it anew. -->\n\n\
         Messages carry a code. `kiln explain K0101` prints what stands here.\n\n\
         | code | what is wrong |\n| --- | --- |\n",
    );
    for code in Code::ALL {
        let _ = writeln!(page, "| [{code}](#{}) | {} |", code.text().to_lowercase(), code.title());
    }
    for code in Code::ALL {
        // The heading is the code alone, for its anchor stays when words change.
        let body = explain(*code);
        let body = body.split_once('\n').map_or("", |(_, rest)| rest);
        let _ = write!(page, "\n## {code}\n\n**{}.**\n{}", code.title(), body.trim_end_matches('\n'));
        page.push('\n');
    }
    page
}
