//! A variant laid over its base.

use crate::language::value::{Data, Table, Value};

/// Lays a partial document over another: tables are merged, everything else is replaced.
///
/// Depth is that of the values, which parsing bounds.
pub(crate) fn overlay(base: &mut Table, partial: &Value) {
    let Data::Table(partial) = &partial.data else { return };
    for (name, entry) in &partial.entries {
        match base.entries.get_mut(name) {
            Some(under) if both_tables(&under.value, &entry.value) => {
                if let Data::Table(table) = &mut under.value.data {
                    overlay(table, &entry.value);
                }
            }
            _ => {
                base.entries.insert(name.clone(), entry.clone());
            }
        }
    }
}

fn both_tables(one: &Value, other: &Value) -> bool {
    // A generator is a value: half of one and half of another would be neither.
    let plain = |value: &Value| value.table().is_some_and(|table| table.get("each").is_none());
    plain(one) && plain(other)
}
