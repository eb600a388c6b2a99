//! Names put together: unknown ones, wrong families, circles, and what a document shows.

use std::collections::{BTreeMap, BTreeSet};

use indexmap::IndexMap;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::reader::{Reader, backtick};
use crate::language::spec::reference::{Family, Link, Use};
use crate::language::spec::section::{place_of, titled};
use crate::language::suggest::closest;
use crate::language::value::{Data, Table};

/// Lists of names longer than this are not shown.
const LISTED: usize = 12;

/// The names of a document, whether what they name could be read or not.
pub(crate) struct Names {
    families: BTreeMap<Family, IndexMap<String, Span>>,
}

impl Names {
    /// The names of an evaluated document.
    pub(crate) fn of(table: &Table) -> Self {
        let names = |family: Family| {
            let mut names = IndexMap::new();
            if let Some(Data::Table(entries)) = table.get(family.text()).map(|value| &value.data) {
                names.extend(entries.entries.iter().map(|(name, entry)| (name.clone(), place_of(entry))));
            }
            (family, names)
        };
        Self { families: Family::ALL.into_iter().map(names).collect() }
    }

    fn find(&self, family: Family, name: &str) -> Option<Span> {
        self.families.get(&family)?.get(name).copied()
    }

    fn list(&self, family: Family) -> impl Iterator<Item = &str> {
        self.families.get(&family).into_iter().flat_map(|names| names.keys().map(String::as_str))
    }
}

/// Checks every name that was used; the shapes that a document without nodes shows, and which definition uses which.
///
/// Cost: linear in the names and their uses, but for sorting these.
pub(crate) fn resolve(names: &Names, deepest: u32, reader: &mut Reader<'_>) -> (Vec<String>, Vec<Link>) {
    let uses = std::mem::take(&mut reader.uses);
    for one in &uses {
        if names.find(one.family, &one.name).is_none() {
            reader.report(unknown(one, names));
        }
    }
    // Shapes are made of fields, and fields of shapes.
    let bodies = [Family::Shape, Family::Field];
    Graph::of(&bodies, names, &uses).check(deepest, reader);
    for family in Family::ALL.into_iter().filter(|family| !bodies.contains(family)) {
        Graph::of(&[family], names, &uses).check(deepest, reader);
    }
    let shapes: Vec<&Use> = uses.iter().filter(|one| one.family == Family::Shape).collect();
    let by = |one: &Use, family: Family| {
        one.user.as_ref().filter(|user| user.0 == family).map(|user| user.1.clone())
    };
    // A skin or a morph moves a shape, and a collider stands for one, which is shown all the same.
    let moves = |one: &Use| {
        let beside = [Family::Skin, Family::Collider].into_iter().any(|family| by(one, family).is_some());
        beside || by(one, Family::Morph).as_ref() == Some(&one.name)
    };
    let states: BTreeSet<&str> =
        (shapes.iter().filter(|one| by(one, Family::Morph).is_some() && !moves(one)))
            .map(|one| one.name.as_str())
            .collect();
    let moved: BTreeSet<&str> =
        names.families.get(&Family::Morph).into_iter().flatten().map(|(name, _)| name.as_str()).collect();
    // So is a shape whose states are made of it.
    let of_state = |one: &Use| {
        moved.contains(one.name.as_str())
            && by(one, Family::Shape).is_some_and(|user| states.contains(user.as_str()))
    };
    let using = shapes.iter().filter(|one| !moves(one) && !of_state(one));
    let used: BTreeSet<&str> = using.map(|one| one.name.as_str()).collect();
    let roots = names.list(Family::Shape).filter(|name| !used.contains(name)).map(str::to_owned).collect();
    (roots, links(&uses))
}

/// Which definition uses which, each once.
fn links(uses: &[Use]) -> Vec<Link> {
    let link = |one: &Use| Some(Link { user: one.user.clone()?, used: (one.family, one.name.clone()) });
    let all: BTreeSet<Link> = uses.iter().filter_map(link).collect();
    all.into_iter().collect()
}

fn unknown(one: &Use, names: &Names) -> Diagnostic {
    // Morphs are called as their shapes.
    let mut others = Family::ALL.into_iter().filter(|family| *family != Family::Morph);
    let other = others.find_map(|family| names.find(family, &one.name).map(|span| (family, span)));
    if let Some((family, span)) = other {
        let message = format!("{} is a {}, not a {}", backtick(&one.name), family.text(), one.family.text());
        return Diagnostic::error(Code::WrongFamily, message)
            .at(one.span, format!("expected the name of a {}", one.family.text()))
            .also(span, format!("defined as a {}", family.text()));
    }
    let message = format!("there is no {}", titled(one.family, &one.name));
    let report = Diagnostic::error(Code::UnknownName, message).at(one.span, "not defined");
    if let Some(near) = closest(&one.name, names.list(one.family)) {
        let written = if one.quoted { format!("\"{near}\"") } else { near.to_owned() };
        return report.suggest(one.span, written, format!("did you mean `{near}`?"));
    }
    let parts: Vec<&str> = one.name.split('-').collect();
    if !one.quoted && parts.len() > 1 && parts.iter().all(|part| names.find(one.family, part).is_some()) {
        return report.suggest(one.span, parts.join(" - "), "put spaces around the minus sign");
    }
    let known: Vec<_> = names.list(one.family).collect();
    match known.len() {
        0 => report.note(format!("this document defines no {}", one.family.text())),
        1..=LISTED => report.note(format!("{}s: {}", one.family.text(), known.join(", "))),
        _ => report,
    }
}

/// Which definitions of some families use which others of them.
struct Graph<'n> {
    names: Vec<(Family, &'n str)>,
    edges: Vec<Vec<(usize, Span)>>,
}

/// How far the search has come with a definition.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    New,
    Open,
    /// Finished; the longest chain of definitions that begins here.
    Done(u32),
}

impl<'n> Graph<'n> {
    fn of(families: &[Family], names: &'n Names, uses: &[Use]) -> Self {
        let all = families.iter().flat_map(|family| names.list(*family).map(|name| (*family, name)));
        let index: IndexMap<(Family, &str), usize> = all.zip(0..).collect();
        let mut edges = vec![Vec::new(); index.len()];
        for one in uses.iter().filter(|one| families.contains(&one.family)) {
            let from = one.user.as_ref().and_then(|(family, name)| index.get(&(*family, name.as_str())));
            if let (Some(from), Some(to)) = (from, index.get(&(one.family, one.name.as_str()))) {
                edges[*from].push((*to, one.span));
            }
        }
        Self { names: index.into_keys().collect(), edges }
    }

    /// Depth-first search without recursion: reports each circle that closes and chains that are too long.
    fn check(&self, deepest: u32, reader: &mut Reader<'_>) {
        let mut marks = vec![Mark::New; self.names.len()];
        for start in 0..self.names.len() {
            if marks[start] == Mark::New {
                self.search(start, &mut marks, deepest, reader);
            }
        }
    }

    fn search(&self, start: usize, marks: &mut [Mark], deepest: u32, reader: &mut Reader<'_>) {
        // Each step of the path: a definition, and how many of its uses were followed.
        let mut path = vec![(start, 0)];
        marks[start] = Mark::Open;
        while let Some((at, next)) = path.last_mut() {
            let Some((to, span)) = self.edges[*at].get(*next).copied() else {
                let depth = self.depth(*at, marks);
                marks[*at] = Mark::Done(depth);
                if depth == deepest.saturating_add(1) {
                    reader.report(self.too_deep(*at, deepest));
                }
                path.pop();
                continue;
            };
            *next += 1;
            match marks[to] {
                Mark::New => {
                    marks[to] = Mark::Open;
                    path.push((to, 0));
                }
                Mark::Open => reader.report(self.circle(&path, to, span)),
                Mark::Done(_) => {}
            }
        }
    }

    fn depth(&self, at: usize, marks: &[Mark]) -> u32 {
        let below = self.edges[at].iter().map(|(to, _)| match marks[*to] {
            Mark::Done(depth) => depth,
            _ => 0,
        });
        below.max().unwrap_or(0).saturating_add(1)
    }

    fn circle(&self, path: &[(usize, usize)], to: usize, span: Span) -> Diagnostic {
        let start = path.iter().position(|(at, _)| *at == to).unwrap_or(0);
        let names: Vec<&str> = path[start..].iter().map(|(at, _)| self.names[*at].1).collect();
        let (family, first) = self.names[to];
        let alike = path[start..].iter().all(|(at, _)| self.names[*at].0 == family);
        let whose = if alike { family.text() } else { "definition" };
        let message = match names.as_slice() {
            [_] => format!("{} refers to itself", titled(family, first)),
            _ => format!("{whose}s refer to each other in a circle: {} -> {first}", names.join(" -> ")),
        };
        let mut report = Diagnostic::error(Code::Cycle, message).at(span, format!("leads back to `{first}`"));
        for (at, followed) in &path[start..path.len() - 1] {
            let (to, span) = self.edges[*at][followed - 1];
            report = report.also(span, format!("`{}` uses `{}`", self.names[*at].1, self.names[to].1));
        }
        report
    }

    fn too_deep(&self, at: usize, deepest: u32) -> Diagnostic {
        let message =
            format!("more than {deepest} {}s refer to each other in a row", self.names[at].0.text());
        let span = self.edges[at].first().map_or(Span::NONE, |(_, span)| *span);
        Diagnostic::error(Code::TooDeep, message)
            .at(span, "too deep")
            .note("`recursion` in [limits] says how many")
    }
}
