//! Answers to what an editor asks of a document.

use serde_json::{Value as Json, json};

use super::desk::{Desk, Sheet, shown};
use super::names::{Name, at, same};
use super::scan::{Kind, Step};
use super::text::{offset, range};
use crate::cli::format::meaning_kept;

/// Why a request has no answer.
pub(super) struct Refusal(pub(super) String);

/// Kinds of completion items and symbols, as the protocol numbers them.
const FIELD: u32 = 5;
const VALUE: u32 = 12;
const MODULE: u32 = 9;
const REFERENCE: u32 = 18;
const SYMBOL: u32 = 5;

impl Desk {
    fn asked<'a>(&self, params: &'a Json) -> Option<(&'a str, &Sheet, usize)> {
        let uri = params["textDocument"]["uri"].as_str()?;
        let sheet = self.sheets.get(uri)?;
        Some((uri, sheet, offset(&sheet.text, &params["position"], self.encoding)))
    }

    pub(super) fn completion(&self, params: &Json) -> Option<Json> {
        let (_, sheet, place) = self.asked(params)?;
        let (kind, path) = sheet.scan.around(place);
        let part = sheet.scan.part(place);
        let quoted = part.is_some_and(|part| part.quoted);
        let replaced = part.map_or(place..place, super::scan::Part::inner);
        let item = |label: &str, text: &str, kind: u32, about: &str, replaced: &std::ops::Range<usize>| {
            json!({
                "label": label, "kind": kind,
                "documentation": { "kind": "markdown", "value": about },
                "textEdit": { "range": range(&sheet.text, replaced, self.encoding), "newText": text },
            })
        };
        let mut items = Vec::new();
        let guide = self.guide(params["textDocument"]["uri"].as_str()?);
        match kind {
            Kind::Header | Kind::Key => {
                let here = |key: &str| {
                    let stands = |other: &&super::scan::Part| {
                        other.kind == kind && kind == Kind::Key && *other.path == *path && other.text == key
                    };
                    sheet
                        .scan
                        .parts
                        .iter()
                        .filter(stands)
                        .any(|other| !other.range.contains(&place) && other.range.end != place)
                };
                for word in guide.keys(&path).into_iter().filter(|word| !here(&word.text)) {
                    let follows = sheet.text[replaced.end..].trim_start_matches([' ', '\t']);
                    let text = if kind == Kind::Key && !follows.starts_with('=') {
                        format!("{} = ", word.text)
                    } else {
                        word.text.clone()
                    };
                    let kind = if word.table { MODULE } else { FIELD };
                    items.push(item(&word.text, &text, kind, &word.description, &replaced));
                }
            }
            Kind::Value if part.is_some_and(|part| part.quoted && part.text.starts_with('=')) => {
                let word = at(&sheet.names, place).map_or(place..place, |name| name.range.clone());
                let given = sheet.names.iter().filter(|name| name.given && name.section == "parameters");
                items
                    .extend(given.map(|name| item(&name.text, &name.text, REFERENCE, "A parameter.", &word)));
            }
            Kind::Value => {
                for word in guide.words(&path) {
                    let bare = word.trim_matches('"');
                    let text = if quoted { bare } else { word.as_str() };
                    items.push(item(bare, text, VALUE, "", &replaced));
                }
                if let Some(section) = guide.section(&path) {
                    let uri = params["textDocument"]["uri"].as_str()?;
                    for (_, _, names) in self.family(uri) {
                        for name in names.iter().filter(|name| name.given && name.section == section) {
                            let text = if quoted { name.text.clone() } else { format!("\"{}\"", name.text) };
                            let about = format!("`[{section}.{}]`", name.text);
                            let new = item(&name.text, &text, REFERENCE, &about, &replaced);
                            if !items.contains(&new) {
                                items.push(new);
                            }
                        }
                    }
                }
            }
        }
        Some(json!({ "isIncomplete": false, "items": items }))
    }

    pub(super) fn hover(&mut self, params: &Json) -> Option<Json> {
        let (uri, sheet, place) = self.asked(params)?;
        let part = sheet.scan.part(place)?.clone();
        let shown_range = range(&sheet.text, &part.range, self.encoding);
        let mut text = self.guide(uri).about(&part.own_path());
        let named = match (&part.kind, &*part.own_path()) {
            (Kind::Header, [Step::Key(section), Step::Key(name), ..]) => {
                Some((section.clone(), name.clone()))
            }
            (Kind::Value, _) => at(&sheet.names, place).map(|name| (name.section.clone(), name.text.clone())),
            _ => None,
        };
        let uri = uri.to_owned();
        if let Some((section, name)) = named
            && let Some(facts) = self.facts(&uri, &section, &name)
        {
            text.push_str(&format!("\n\n`{name}`: {facts}"));
        }
        let text = text.trim();
        (!text.is_empty())
            .then(|| json!({ "contents": { "kind": "markdown", "value": text }, "range": shown_range }))
    }

    /// The places of a name in a document and what it includes.
    fn places(&self, params: &Json, wanted: impl Fn(&Name) -> bool) -> Option<Vec<(String, Json)>> {
        let (uri, sheet, place) = self.asked(params)?;
        let name = at(&sheet.names, place)?;
        let all = self.family(uri);
        let given = all.iter().flat_map(|(.., names)| names).any(|other| other.given && same(name, other));
        let mut found = Vec::new();
        for (uri, text, names) in &all {
            let same = names.iter().filter(|other| given && same(name, other) && wanted(other));
            found.extend(same.map(|other| (uri.clone(), range(text, &other.range, self.encoding))));
        }
        Some(found)
    }

    pub(super) fn definition(&self, params: &Json) -> Option<Json> {
        let all = self.places(params, |name| name.given)?;
        // A name is given in its first header; the others add to it.
        let first = all.first()?;
        Some(json!({ "uri": first.0, "range": first.1 }))
    }

    pub(super) fn references(&self, params: &Json) -> Option<Json> {
        let given = params["context"]["includeDeclaration"] != false;
        let all = self.places(params, |name| given || !name.given)?;
        Some(all.into_iter().map(|(uri, range)| json!({ "uri": uri, "range": range })).collect())
    }

    pub(super) fn prepare_rename(&self, params: &Json) -> Option<Json> {
        let (_, sheet, place) = self.asked(params)?;
        let name = at(&sheet.names, place)?;
        self.places(params, |_| true).filter(|all| !all.is_empty())?;
        Some(json!({ "range": range(&sheet.text, &name.range, self.encoding), "placeholder": name.text }))
    }

    pub(super) fn rename(&self, params: &Json) -> Result<Json, Refusal> {
        let new = params["newName"].as_str().unwrap_or_default();
        let word = |part: &str| {
            !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        };
        if !(new.starts_with(|c: char| c.is_ascii_lowercase()) && new.split('-').all(word)) {
            let reason = format!("`{new}` is no name: names are lower-case words and digits joined by `-`");
            return Err(Refusal(reason));
        }
        let all = self.places(params, |_| true).unwrap_or_default();
        if all.is_empty() {
            return Err(Refusal("no name stands there".to_owned()));
        }
        if let Some((uri, sheet, place)) = self.asked(params)
            && let Some(name) = at(&sheet.names, place)
        {
            let taken = Name { text: new.to_owned(), ..name.clone() };
            let family = self.family(uri);
            if family.iter().flat_map(|(.., names)| names).any(|other| other.given && same(&taken, other)) {
                return Err(Refusal(format!("there is a {} `{new}` already", name.section)));
            }
        }
        let mut changes = serde_json::Map::new();
        for (uri, range) in all {
            let edits = changes.entry(uri).or_insert_with(|| json!([]));
            edits.as_array_mut().expect("an array").push(json!({ "range": range, "newText": new }));
        }
        Ok(json!({ "changes": changes }))
    }

    pub(super) fn formatting(&self, params: &Json) -> Option<Json> {
        let sheet = self.sheets.get(params["textDocument"]["uri"].as_str()?)?;
        let text = meaning_kept(&sheet.text)?;
        if text == sheet.text {
            return Some(json!([]));
        }
        Some(json!([{ "range": range(&sheet.text, &(0..sheet.text.len()), self.encoding), "newText": text }]))
    }

    pub(super) fn symbols(&self, params: &Json) -> Option<Json> {
        let sheet = self.sheets.get(params["textDocument"]["uri"].as_str()?)?;
        let mut seen: Vec<&Name> = Vec::new();
        let mut symbols: Vec<Json> = Vec::new();
        for name in sheet.names.iter().filter(|name| name.given) {
            // A thing may have several headers.
            if seen.iter().any(|known| same(known, name)) {
                continue;
            }
            seen.push(name);
            let shown = range(&sheet.text, &name.range, self.encoding);
            symbols.push(json!({
                "name": name.text, "detail": name.section, "kind": SYMBOL, "range": shown, "selectionRange": shown,
            }));
        }
        Some(json!(symbols))
    }

    /// Colors written as `"#rrggbb"`, and with their alpha.
    pub(super) fn colors(&self, params: &Json) -> Option<Json> {
        let sheet = self.sheets.get(params["textDocument"]["uri"].as_str()?)?;
        let color = |part: &super::scan::Part| {
            let digits = part.text.strip_prefix('#').filter(|digits| matches!(digits.len(), 6 | 8))?;
            let value = u32::from_str_radix(digits, 16).ok()?;
            let value = if digits.len() == 6 { value << 8 | 0xff } else { value };
            let [red, green, blue, alpha] = value.to_be_bytes().map(|byte| f64::from(byte) / 255.0);
            Some(json!({
                "range": range(&sheet.text, &part.range, self.encoding),
                "color": { "red": red, "green": green, "blue": blue, "alpha": alpha },
            }))
        };
        Some(
            sheet
                .scan
                .parts
                .iter()
                .filter(|part| part.kind == Kind::Value && part.quoted)
                .filter_map(color)
                .collect(),
        )
    }

    /// How a color that was chosen is written.
    pub(super) fn color_text(params: &Json) -> Json {
        let part = |key: &str| {
            let share = params["color"][key].as_f64().unwrap_or(1.0).clamp(0.0, 1.0);
            format!("{:02x}", crate::geometry::number::floor_count(share * 255.0 + 0.5))
        };
        let alpha = part("alpha");
        let alpha = if alpha == "ff" { String::new() } else { alpha };
        let text = format!("\"#{}{}{}{alpha}\"", part("red"), part("green"), part("blue"));
        json!([{ "label": text, "textEdit": { "range": params["range"], "newText": text } }])
    }

    /// Changes that mend what is wrong in a range.
    pub(super) fn actions(&self, params: &Json) -> Option<Json> {
        let uri = params["textDocument"]["uri"].as_str()?;
        let list = self.sheets.get(uri)?.found.as_ref()?;
        let lines = |range: &Json| (range["start"]["line"].as_u64(), range["end"]["line"].as_u64());
        let (first, last) = lines(&params["range"]);
        let action = |(_, one): (String, Json)| {
            let (from, to) = lines(&one["range"]);
            let data = one.get("data").filter(|_| from <= last && to >= first)?;
            let uri = data["uri"].as_str()?;
            Some(json!({
                "title": data["title"], "kind": "quickfix", "isPreferred": true, "diagnostics": [one],
                "edit": { "changes": { uri: [data["edit"]] } },
            }))
        };
        Some(list.iter().filter_map(|one| shown(one, list, (uri, self))).filter_map(action).collect())
    }
}
