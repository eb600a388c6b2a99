//! Assertions of a document, held against its report.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{Assertion, Demand, Expected};
use crate::report::{Check, Report};

/// Holds an assertion against a report.
///
/// # Errors
/// Why it does not hold.
pub(super) fn assert(report: &Report, assertion: &Assertion) -> Result<Check, Box<Diagnostic>> {
    let path = &assertion.path.value;
    let found = report.fact(path).map_err(|fault| {
        let message = format!("the report has no `{}`, asked for by `{path}`", fault.missing);
        let known = fault.known.iter().map(String::as_str);
        let near = crate::language::spec::closest(&fault.missing, known).map(str::to_owned);
        let mut report =
            Diagnostic::error(Code::UnknownFact, message).at(assertion.path.span, "no such fact");
        if !fault.known.is_empty() {
            report = report.note(format!("there is: {}", fault.known.join(", ")));
        }
        if let Some(near) = near {
            report = report.help(format!("did you mean `{near}`?"));
        }
        Box::new(report)
    })?;
    let demand = demanded(&assertion.demand);
    if holds(&assertion.demand, &found) {
        return Ok(Check { path: path.clone(), found });
    }
    let message = format!("assertion failed: `{path}` is {found}, not {demand}");
    Err(Box::new(
        Diagnostic::error(Code::AssertionFailed, message).at(assertion.span, format!("found {found}")),
    ))
}

fn holds(demand: &Demand, found: &serde_json::Value) -> bool {
    match demand {
        Demand::Equals(Expected::Number(number)) => found.as_f64() == Some(*number),
        Demand::Equals(Expected::Boolean(truth)) => found.as_bool() == Some(*truth),
        Demand::Equals(Expected::Text(text)) => found.as_str() == Some(text),
        Demand::Bounds { at_most, at_least, equals, tolerance } => found.as_f64().is_some_and(|found| {
            at_most.is_none_or(|most| found <= most)
                && at_least.is_none_or(|least| found >= least)
                && equals.is_none_or(|number| (found - number).abs() <= *tolerance)
        }),
    }
}

fn demanded(demand: &Demand) -> String {
    match demand {
        Demand::Equals(Expected::Number(number)) => number.to_string(),
        Demand::Equals(Expected::Boolean(truth)) => truth.to_string(),
        Demand::Equals(Expected::Text(text)) => format!("\"{text}\""),
        Demand::Bounds { at_most, at_least, equals, tolerance } => {
            let bounds = [
                at_least.map(|least| format!("at least {least}")),
                at_most.map(|most| format!("at most {most}")),
                equals.map(|number| format!("{number} give or take {tolerance}")),
            ];
            bounds.into_iter().flatten().collect::<Vec<_>>().join(" and ")
        }
    }
}
