//! Planted cases where effects are taken out of the list: what has one of them is then in nobody's list.

use asami_sim::effects::catalogue;

use crate::weigh::causes::{NONE, UNKNOWN, is_single, is_unknown, leader};
use crate::weigh::practice::Case;

/// A planted case as it is with a shorter list.
#[derive(Clone, Debug, PartialEq)]
pub struct Left {
    /// What speaks for the causes that are left, and the truth among them.
    pub case: Case,
    /// Whether it is the case itself; else what it would be were its effect in nobody's list.
    pub planted: bool,
}

/// Cases as they would be without these effects in the list. Those with one of them planted are of the *unknown* then; those
/// with another beside it are left out, since nobody has looked what a flexible block makes of them.
#[must_use]
pub fn less(cases: &[Case], without: &[String]) -> Vec<Left> {
    let gone = |cause: &str| cause.split('+').any(|effect| without.iter().any(|it| it == effect));
    let mut left = Vec::with_capacity(cases.len());
    for (i, case) in cases.iter().enumerate() {
        let stand_in = i.checked_sub(1).and_then(|i| cases.get(i)).filter(|it| is_unknown(&it.truth));
        let of = |planted: bool, case: &Case| Left { case: shortened(case, &gone), planted };
        let shown = case.shown.as_deref().unwrap_or(&case.truth);
        if is_unknown(&case.truth) {
            // One that stands in for the case after it counts as that case.
            let next = cases.get(i + 1).map(|it| it.shown.as_deref().unwrap_or(&it.truth));
            if !next.is_some_and(gone) {
                left.push(of(false, case));
            }
        } else if !gone(&case.truth) {
            left.push(of(true, case));
        } else if gone(shown) && is_single(shown) {
            left.extend(stand_in.map(|it| of(true, it)).or_else(|| Some(of(true, &unlisted(case, shown, &gone)?))));
        }
    }
    left
}

/// A case whose effect nothing stands in for, as one of the *unknown*: of an effect that does not show, or that another in the
/// list explains as well. `None` where blocks were put on top of what is gone.
fn unlisted(case: &Case, shown: &str, gone: &dyn Fn(&str) -> bool) -> Option<Case> {
    let about = catalogue().into_iter().find(|about| about.name == shown)?;
    let truth = format!("{UNKNOWN}/{}", about.block.name());
    let leader = leader(&case.evidence);
    let stands = leader == NONE || !gone(leader);
    stands.then(|| Case { truth, shown: None, absorbed_nats: None, off_by: None, ..case.clone() })
}

fn shortened(case: &Case, gone: &dyn Fn(&str) -> bool) -> Case {
    let mut case = case.clone();
    case.evidence.retain(|cause, _| !gone(cause));
    case
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weigh::causes::Evidence;

    /// Of these two effects, one of timing and one of the sensor.
    const EFFECTS: [&str; 2] = ["image_delay", "height_bias"];

    fn case(truth: &str, shown: Option<&str>, nats: [f64; 2]) -> Case {
        let [a, b] = EFFECTS;
        let pair = format!("{b}+{a}");
        let evidence = [(a, nats[0]), (b, nats[1]), (&*pair, 6.0), ("unknown/timing", 2.0), ("unknown/sensor", 1.0)];
        let evidence = Evidence::from(evidence.map(|(cause, nats)| (cause.to_owned(), nats)));
        let (truth, shown) = (truth.to_owned(), shown.map(str::to_owned));
        Case { truth, shown, evidence, absorbed_nats: Some(0.1), off_by: Some(0.5) }
    }

    fn truths(left: &[Left]) -> Vec<(&str, bool)> {
        left.iter().map(|it| (&*it.case.truth, it.planted)).collect()
    }

    #[test]
    fn without_anything_taken_out_all_stays_as_it_is() {
        let cases = [case("unknown/timing", None, [5.0, 1.0]), case(EFFECTS[0], None, [5.0, 1.0])];
        let left = less(&cases, &[]);
        assert_eq!(left.iter().map(|it| &it.case).collect::<Vec<_>>(), cases.iter().collect::<Vec<_>>());
        assert_eq!(left.iter().map(|it| it.planted).collect::<Vec<_>>(), [false, true]);
    }

    #[test]
    fn effects_out_of_the_list_speak_for_nothing_and_are_unknown_themselves() {
        let [a, b] = EFFECTS;
        let pair = format!("{b}+{a}");
        let cases = [
            case("unknown/timing", None, [-1.0, 1.0]),
            case(a, None, [5.0, 1.0]),
            case(&pair, None, [5.0, 4.0]),
            case("unknown/sensor", None, [1.0, -1.0]),
            case(b, None, [1.0, 5.0]),
            case(NONE, None, [0.0, 0.0]),
        ];
        let left = less(&cases, &[a.to_owned()]);
        // What stood in for the case that was planted is that case now.
        let expected = [("unknown/timing", true), ("unknown/sensor", false), (b, true), (NONE, true)];
        assert_eq!(truths(&left), expected);
        assert!(left.iter().all(|it| it.case.evidence.keys().eq([b, "unknown/sensor", "unknown/timing"])), "{left:?}");
    }

    /// What does not show has nothing that stands in for it, and is there all the same.
    #[test]
    fn an_effect_out_of_the_list_that_does_not_show_is_unknown_and_not_none() {
        let [a, b] = EFFECTS;
        let mut unseen = case(a, None, [0.5, 0.2]);
        unseen.evidence.retain(|cause, _| !cause.contains('+'));
        let left = less(&[unseen.clone(), case(NONE, None, [0.0, 0.0])], &[a.to_owned()]);
        assert_eq!(truths(&left), [("unknown/timing", true), (NONE, true)]);
        assert_eq!(left[0].case.off_by, None);
        // Of two effects the one that shows is gone; of a case whose blocks stand on what is gone, nothing is known.
        let pair = format!("{b}+{a}");
        let hidden = case(&pair, Some(a), [0.5, 0.2]);
        assert_eq!(truths(&less(&[Case { evidence: unseen.evidence, ..hidden }], &[a.to_owned()])).len(), 1);
        assert!(less(&[case(a, None, [9.0, 0.2])], &[a.to_owned()]).is_empty());
    }
}
