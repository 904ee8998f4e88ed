//! What can be asked of a case: rules of combination and what there is around them.

use wisdom_belief::rule::{self, Settings};
use wisdom_belief::{
    BeliefError, Distribution, Element, Frame, MassFunction, Region, Rule, Uncertainty, Weights,
};

use super::answer::Answer;
use super::case::{Case, CaseError};

/// An operation that is no rule of combination.
struct Operation {
    name: &'static str,
    summary: &'static str,
    /// The parameters it knows.
    params: &'static [&'static str],
    answer: How,
}

/// What an operation needs to know of a case, and what it answers.
enum How {
    /// A number of one source.
    Number(fn(&MassFunction, &Frame) -> Result<f64, BeliefError>),
    /// A number of one source and each element asked for.
    OfElements(fn(&MassFunction, Element) -> f64),
    /// A probability of each element asked for.
    Probability(Distribute),
    /// A probability of each Venn region asked for.
    OfRegions(Distribute),
    /// Something else.
    Other(fn(&Case) -> Result<Answer, CaseError>),
}

/// A probability over the regions of the frame, from the only source of a case.
type Distribute = fn(&Case, &MassFunction) -> Result<Distribution, CaseError>;

use How::{Number, OfElements, OfRegions, Other, Probability};

const OPERATIONS: &[Operation] = &[
    op(
        "discount",
        "moves 1 - params.reliability of each mass to Theta",
        &["reliability"],
        Other(discount),
    ),
    op(
        "contextual_discount",
        "by params.reliabilities {context: number}",
        &["reliabilities"],
        Other(|case| {
            let contexts = case.by_element("reliabilities")?;
            masses(case, &case.only_source()?.contextually_discounted(&contexts, &case.frame)?)
        }),
    ),
    op(
        "contextual_reinforcement",
        "by params.reliabilities {context: number}",
        &["reliabilities"],
        Other(|case| {
            let contexts = case.by_element("reliabilities")?;
            masses(case, &case.only_source()?.contextually_reinforced(&contexts, &case.frame)?)
        }),
    ),
    op(
        "condition",
        "on params.on, by Dempster's rule",
        &["on"],
        Other(|case| {
            let on = case.element("on", &case.frame)?;
            masses(case, &case.only_source()?.conditioned(on, &case.frame)?)
        }),
    ),
    op(
        "condition_unnormalised",
        "on params.on, conflict left on empty",
        &["on"],
        Other(|case| {
            let on = case.element("on", &case.frame)?;
            masses(case, &case.only_source()?.conditioned_unnormalised(on, &case.frame)?)
        }),
    ),
    op(
        "decombine",
        "takes the second source out of the first",
        &[],
        Other(|case| {
            let [whole, part] = case.pair()?;
            masses(case, &whole.decombined(&part, &case.frame)?)
        }),
    ),
    op(
        "reassign",
        "moves the mass of params.from to params.to, then applies the model",
        &["from", "to"],
        Other(reassign),
    ),
    op("bel", "belief", &[], OfElements(MassFunction::belief)),
    op("pl", "plausibility", &[], OfElements(MassFunction::plausibility)),
    op("q", "commonality", &[], OfElements(MassFunction::commonality)),
    op("b", "implicability", &[], OfElements(MassFunction::implicability)),
    op("betp", "pignistic probability", &[], Probability(betp)),
    op("dsmp", "DSmP of params.epsilon", &["epsilon"], Probability(dsmp)),
    op(
        "plausibility_transform",
        "plausibilities of the regions, scaled to sum to 1",
        &[],
        Probability(plp),
    ),
    op("betp_region", "pignistic probability of single Venn regions", &[], OfRegions(betp)),
    op(
        "dsmp_region",
        "DSmP of params.epsilon of single Venn regions",
        &["epsilon"],
        OfRegions(dsmp),
    ),
    op("plausibility_transform_region", "the same of single Venn regions", &[], OfRegions(plp)),
    op(
        "cardinality",
        "Venn regions of each element",
        &[],
        Other(|case| each(case, |a| f64::from(a.cardinality()))),
    ),
    op(
        "hyper_power_size",
        "elements of the (hyper-)power set",
        &[],
        Other(|case| Ok(Answer::Scalar(case.frame.element_count() as f64))),
    ),
    op(
        "conjunctive_weights",
        "w of the canonical decomposition",
        &[],
        Other(|case| listed(case, &case.only_source()?.conjunctive_weights(&case.frame)?)),
    ),
    op(
        "disjunctive_weights",
        "v of the canonical decomposition",
        &[],
        Other(|case| listed(case, &case.only_source()?.disjunctive_weights(&case.frame)?)),
    ),
    op(
        "conflict",
        "K, the conjunctive mass of empty",
        &[],
        Other(|case| Ok(Answer::Scalar(rule::conflict(&case.translated()?, &case.frame)?))),
    ),
    op("auto_conflict", "K of params.order copies of the source", &["order"], Other(auto_conflict)),
    op(
        "jousselme",
        "distance of two sources",
        &[],
        Other(|case| {
            let [a, b] = case.pair()?;
            Ok(Answer::Scalar(a.jousselme_distance(&b)))
        }),
    ),
    op(
        "nonspecificity",
        "generalised Hartley measure, in bits",
        &[],
        Number(|m, _| m.nonspecificity()),
    ),
    op("deng_entropy", "Deng entropy, in bits", &[], Number(|m, _| m.deng_entropy())),
    op(
        "nguyen_entropy",
        "Shannon entropy of the masses, in bits",
        &[],
        Number(|m, _| m.nguyen_entropy()),
    ),
    op("confusion", "Höhle's confusion, in bits", &[], Number(|m, _| m.confusion())),
    op("dissonance", "Yager's dissonance, in bits", &[], Number(|m, _| m.dissonance())),
    op("discord", "Klir and Ramer's discord, in bits", &[], Number(|m, _| m.discord())),
    op("strife", "Klir and Parviz's strife, in bits", &[], Number(|m, _| m.strife())),
    op(
        "ambiguity",
        "Shannon entropy of the pignistic probabilities, in bits",
        &[],
        Number(MassFunction::ambiguity),
    ),
    op(
        "jirousek_shenoy_entropy",
        "entropy of Jiroušek and Shenoy, in bits",
        &[],
        Number(MassFunction::jirousek_shenoy_entropy),
    ),
    op(
        "pic_betp",
        "information content of the pignistic probabilities",
        &[],
        Other(|case| Ok(Answer::Scalar(betp(case, &case.only_source()?)?.information_content()))),
    ),
    op(
        "pic_dsmp",
        "information content of DSmP of params.epsilon",
        &["epsilon"],
        Other(|case| Ok(Answer::Scalar(dsmp(case, &case.only_source()?)?.information_content()))),
    ),
];

const fn op(
    name: &'static str,
    summary: &'static str,
    params: &'static [&'static str],
    answer: How,
) -> Operation {
    Operation { name, summary, params, answer }
}

fn betp(case: &Case, source: &MassFunction) -> Result<Distribution, CaseError> {
    Ok(source.pignistic_distribution(&case.frame)?)
}

fn dsmp(case: &Case, source: &MassFunction) -> Result<Distribution, CaseError> {
    Ok(source.dsmp_distribution(case.number("epsilon")?, &case.frame)?)
}

fn plp(case: &Case, source: &MassFunction) -> Result<Distribution, CaseError> {
    Ok(source.plausibility_distribution(&case.frame)?)
}

fn discount(case: &Case) -> Result<Answer, CaseError> {
    let reliability = case.number("reliability")?;
    let Ok(u) = Uncertainty::new(1.0 - reliability) else {
        let message = format!("params.reliability is {reliability}; it lies in [0, 1]");
        return Err(CaseError { code: "parameter", ..CaseError::malformed(message) });
    };
    masses(case, &case.only_source()?.discounted(u, &case.frame))
}

fn auto_conflict(case: &Case) -> Result<Answer, CaseError> {
    let order = case.number("order")?;
    if order.fract() != 0.0 || !(1.0..=1e6).contains(&order) {
        let message = format!("params.order is {order}; expected a whole number from 1 to 1e6");
        return Err(CaseError { code: "parameter", ..CaseError::malformed(message) });
    }
    Ok(Answer::Scalar(case.only_source()?.auto_conflict(order as u32)?))
}

/// The names of all operations, rules first, and what each does.
pub(super) fn list() -> impl Iterator<Item = (String, &'static str)> {
    let rules = Rule::ALL.into_iter().map(|rule| (rule.name().replace('-', "_"), rule.summary()));
    rules.chain(OPERATIONS.iter().map(|op| (op.name.to_owned(), op.summary)))
}

/// Answers a case.
pub(super) fn answer(case: &Case) -> Result<Answer, CaseError> {
    if let Some(operation) = OPERATIONS.iter().find(|operation| operation.name == case.rule) {
        check_params(case, operation.params)?;
        return match &operation.answer {
            Number(measure) => Ok(Answer::Scalar(measure(&case.only_source()?, &case.frame)?)),
            OfElements(measure) => {
                let source = case.only_source()?;
                each(case, |a| measure(&source, a))
            }
            Probability(distribute) => {
                let distribution = distribute(case, &case.only_source()?)?;
                each(case, |a| distribution.probability(a))
            }
            OfRegions(distribute) => {
                let distribution = distribute(case, &case.only_source()?)?;
                each_region(case, |region| distribution.of(region))
            }
            Other(answer) => answer(case),
        };
    }
    let (name, sequential) = match case.rule.strip_suffix("_sequential") {
        Some(name) => (name, true),
        None => (case.rule.as_str(), false),
    };
    let Ok(rule) = name.parse::<Rule>() else {
        let names: Vec<String> = list().map(|(name, _)| name).collect();
        let message = format!("rule `{}` is unknown; known: {}", case.rule, names.join(", "));
        return Err(CaseError { code: "unknown_rule", ..CaseError::malformed(message) });
    };
    combination(case, rule, sequential)
}

fn combination(case: &Case, rule: Rule, sequential: bool) -> Result<Answer, CaseError> {
    check_params(
        case,
        match rule {
            Rule::Inagaki => &["k"],
            Rule::Average => &["weights"],
            _ => &[],
        },
    )?;
    let weights = case.optional_numbers("weights")?;
    let mut settings = Settings::default();
    if rule == Rule::Inagaki {
        settings = settings.with_inagaki_k(case.number("k")?);
    }
    if let Some(weights) = &weights {
        settings = settings.with_weights(weights);
    }
    if let Some(source_frame) = &case.source_frame {
        settings = settings.with_source_frame(source_frame);
    }
    let combine = if sequential { rule::fold } else { rule::combine_with };
    let fused = combine(rule, &case.sources, &case.frame, &settings)?;
    masses(case, &fused)
}

fn reassign(case: &Case) -> Result<Answer, CaseError> {
    let given_on = case.source_frame.as_ref().unwrap_or(&case.frame);
    let (from, to) = (case.element("from", given_on)?, case.element("to", given_on)?);
    let [source] = case.sources.as_slice() else { return Err(case.source_count("1")) };
    let moved = source.mass(from);
    let kept = source.focal().iter().filter(|&&(element, _)| element != from && element != to);
    let masses_after =
        kept.copied().chain([(to, if from == to { moved } else { source.mass(to) + moved })]);
    let after = MassFunction::new(given_on, masses_after)?;
    masses(case, &case.frame.translate_mass(given_on, &after)?)
}

fn check_params(case: &Case, known: &[&str]) -> Result<(), CaseError> {
    match case.params.keys().find(|name| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => {
            let rule = &case.rule;
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            Err(CaseError::malformed(format!(
                "params.{name} means nothing to operation `{rule}`; known: {known}"
            )))
        }
    }
}

/// All masses above 0, by the expressions asked for where those say the same.
fn masses(case: &Case, fused: &MassFunction) -> Result<Answer, CaseError> {
    let asked = if case.keys.is_some() { case.asked()? } else { Vec::new() };
    let named = |element: Element| {
        let key = asked.iter().find(|&&(_, asked)| asked == element);
        key.map_or_else(|| case.frame.print(element), |(key, _)| key.clone())
    };
    let values = fused.focal().iter().map(|&(element, mass)| (named(element), mass));
    Ok(Answer::Values(values.collect()))
}

/// A number of each element asked for; without `keys`, of each atom.
fn each(case: &Case, number: impl Fn(Element) -> f64) -> Result<Answer, CaseError> {
    let asked = case.asked()?.into_iter();
    Ok(Answer::Values(asked.map(|(key, a)| (key, number(a))).collect()))
}

/// A value of each Venn region asked for, by a comma list of the atoms it lies in; without `keys`, of all.
fn each_region(case: &Case, value: impl Fn(Region) -> f64) -> Result<Answer, CaseError> {
    let frame = &case.frame;
    let Some(keys) = &case.keys else {
        let regions =
            frame.regions().map(|region| (frame.atoms_of(region).join(","), value(region)));
        return Ok(Answer::Values(regions.collect()));
    };
    let read = |key: &String| {
        let atoms: Vec<&str> = key.split(',').map(str::trim).collect();
        Ok((key.clone(), value(frame.region(&atoms)?)))
    };
    Ok(Answer::Values(keys.iter().map(read).collect::<Result<_, CaseError>>()?))
}

/// A weight of each element asked for; without `keys`, of those that have one of their own.
fn listed(case: &Case, weights: &Weights) -> Result<Answer, CaseError> {
    if case.keys.is_some() {
        return each(case, |a| weights.of(a));
    }
    let values = weights.listed().iter().map(|&(a, weight)| (case.frame.print(a), weight));
    Ok(Answer::Values(values.collect()))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn no_two_operations_share_a_name() {
        let names: Vec<String> = list().map(|(name, _)| name).collect();
        let distinct: BTreeSet<&String> = names.iter().collect();
        assert_eq!(distinct.len(), names.len());
        assert!(names.len() > 60);
    }
}
