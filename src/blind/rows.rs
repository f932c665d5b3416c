//! `trials.csv` and `timings.csv`: every case and every diagnoser, the same bytes whatever happened on the way.

use asami_dataset::store::number;

use super::answer::{Answer, NONE, UNKNOWN};
use super::walk::{Record, Results};
use crate::sweep::rows::{optional, push, quoted};

/// Columns of `trials.csv`.
pub const COLUMNS: &str = "scenario,diagnoser,case,effects_true,d_det,d_sep,verdict,effects_named,probability,\
                           top_group_right,in_set90,set_size,place_right,parameter_error,excess_before,excess_after,\
                           closed,oracle_closed,effect_withheld,named_right,true_probability,parameter_covered,\
                           closed_claimed,behaves_like,sizes_true,groups_true,observations,d_each,next_nats,\
                           again_nats,promised_nats,parameter_error_cr,evidence_probability,error";

/// Every case of every diagnoser, by case and then by diagnoser.
#[must_use]
pub fn trials(results: &Results) -> String {
    let mut text = format!("{COLUMNS}\n");
    for (scenario, record) in results.cases() {
        for (diagnoser, answer) in results.question.diagnosers.iter().zip(&record.answers) {
            push(&mut text, &row(scenario, diagnoser, record, answer));
        }
    }
    text
}

fn row(scenario: &str, diagnoser: &str, record: &Record, answer: &Answer) -> Vec<String> {
    let reference = record.reference.as_ref();
    let effects = || reference.into_iter().flat_map(|reference| &reference.effects);
    let listed = record.listed();
    let mut words: Vec<&str> = listed.iter().map(|name| name.as_str()).collect();
    if listed.len() < record.planted.len() {
        words.push(UNKNOWN);
    }
    let truth = if words.is_empty() { NONE.to_owned() } else { words.join("+") };
    let withheld: Vec<&str> = record.planted.iter().filter(|name| !listed.contains(name)).map(String::as_str).collect();
    let answered = !answer.verdict.is_empty();
    // What was never answered has no numbers, and is right in nothing.
    let of_answer = |value: String| if answered { value } else { String::new() };
    let numbers = |value: f64| of_answer(number(value));
    let flag = |value: Option<bool>| value.map_or_else(String::new, |value| value.to_string());
    let sizes: Vec<String> =
        effects().map(|effect| format!("{}.{}={}", effect.name, effect.parameter, number(effect.value))).collect();
    let groups: Vec<String> = effects().map(|effect| effect.group.join("|")).collect();
    let error = if record.error.is_empty() { &answer.error } else { &record.error };
    vec![
        scenario.to_owned(),
        diagnoser.to_owned(),
        record.number.to_string(),
        truth,
        optional(reference.and_then(|reference| reference.d_det)),
        optional(reference.and_then(|reference| reference.d_sep)),
        answer.verdict.clone(),
        answer.named.join("+"),
        numbers(answer.probability),
        answer.top_group_right.to_string(),
        answer.in_set90.to_string(),
        of_answer(answer.set_size.to_string()),
        flag(answer.place_right),
        optional(answer.parameter_error),
        numbers(answer.excess_before),
        numbers(answer.excess_after),
        optional(answer.closed),
        optional(answer.oracle_closed),
        withheld.join("+"),
        answer.named_right.to_string(),
        numbers(answer.true_probability),
        flag(answer.parameter_covered),
        optional(answer.closed_claimed),
        answer.behaves_like.clone().unwrap_or_default(),
        sizes.join(" "),
        groups.join(" "),
        reference.map_or_else(String::new, |reference| reference.observations.to_string()),
        optional(reference.and_then(|reference| reference.d_each)),
        optional(answer.next.map(|next| next.advised_nats)),
        optional(answer.next.map(|next| next.again_nats)),
        optional(answer.next.and_then(|next| next.promised_nats)),
        optional(answer.parameter_error_cr),
        optional(answer.evidence_probability),
        quoted(error),
    ]
}

/// Wall-clock seconds, which no other file holds.
#[must_use]
pub fn timings(results: &Results) -> String {
    let mut text = String::from("scenario,case,diagnoser,wall_s\n");
    for (scenario, record) in results.cases() {
        let (name, case) = (scenario.to_owned(), record.number.to_string());
        push(&mut text, &[name.clone(), case.clone(), String::new(), number(record.timing.log_s)]);
        for (diagnoser, wall_s) in results.question.diagnosers.iter().zip(&record.timing.trials_s) {
            push(&mut text, &[name.clone(), case.clone(), diagnoser.clone(), number(*wall_s)]);
        }
    }
    text
}
