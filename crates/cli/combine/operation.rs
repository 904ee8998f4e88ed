//! What can be asked of a case: rules of combination and what there is around them.

use std::fmt;
use std::iter;

use serde_json::Value;
use wisdom_belief::rule::{self, Settings};
use wisdom_belief::{
    BeliefError, Criterion, Distribution, Element, Frame, MassFunction, Region, Rule, Uncertainty,
    Weights,
};

use super::answer::Answer;
use super::case::{Case, CaseError};

/// An operation that is no rule of combination.
struct Operation {
    name: &'static str,
    summary: &'static str,
    params: &'static [Param],
    answer: How,
}

/// A parameter that an operation knows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Param {
    /// What it is called in `params`.
    pub(crate) name: &'static str,
    /// What it must be.
    what: &'static str,
}

const fn param(name: &'static str, what: &'static str) -> Param {
    Param { name, what }
}

const RELIABILITY: Param = param("reliability", "number in [0, 1]");
const RELIABILITIES: Param = param("reliabilities", "object {expression: number in [0, 1]}");
const ON: Param = param("on", "expression");
const EPSILON: Param = param("epsilon", "number of at least 0");
const ORDER: Param = param("order", "whole number from 1 to 1000");

/// The most copies of a source that are held against each other: the conflict has long settled by then.
const MAX_ORDER: u32 = 1000;

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
        "moves the share 1 - reliability of each mass to Theta",
        &[RELIABILITY],
        Other(discount),
    ),
    op(
        "undiscount",
        "what a source was before `discount`",
        &[RELIABILITY],
        Other(|case| {
            let u = uncertainty(case)?;
            masses(case, &case.only_source()?.undiscounted(u, &case.frame)?)
        }),
    ),
    op(
        "contextual_discount",
        "each context unites with the share 1 - reliability of each mass",
        &[RELIABILITIES],
        Other(|case| {
            let contexts = case.by_element("reliabilities")?;
            masses(case, &case.only_source()?.contextually_discounted(&contexts, &case.frame)?)
        }),
    ),
    op(
        "contextual_reinforcement",
        "each context intersects the share 1 - reliability of each mass",
        &[RELIABILITIES],
        Other(|case| {
            let contexts = case.by_element("reliabilities")?;
            masses(case, &case.only_source()?.contextually_reinforced(&contexts, &case.frame)?)
        }),
    ),
    op(
        "condition",
        "conditions by Dempster's rule",
        &[ON],
        Other(|case| {
            let on = case.element("on", &case.frame)?;
            masses(case, &case.only_source()?.conditioned(on, &case.frame)?)
        }),
    ),
    op(
        "condition_unnormalised",
        "conditions, conflict left on empty",
        &[ON],
        Other(|case| {
            let on = case.element("on", &case.frame)?;
            masses(case, &case.only_source()?.conditioned_unnormalised(on, &case.frame)?)
        }),
    ),
    op(
        "decombine",
        "takes the second source out of the first, which `conjunctive` made",
        &[],
        Other(|case| {
            let [whole, part] = case.pair()?;
            masses(case, &whole.decombined(&part, &case.frame)?)
        }),
    ),
    op(
        "decombine_normalised",
        "takes the second source out of the first, which `dempster` made",
        &[],
        Other(|case| {
            let [whole, part] = case.pair()?;
            masses(case, &whole.decombined_normalised(&part, &case.frame)?)
        }),
    ),
    op(
        "reassign",
        "moves the mass of one element to another, then applies the model",
        &[param("from", "expression"), param("to", "expression")],
        Other(reassign),
    ),
    op("bel", "belief", &[], OfElements(MassFunction::belief)),
    op("pl", "plausibility", &[], OfElements(MassFunction::plausibility)),
    op("q", "commonality", &[], OfElements(MassFunction::commonality)),
    op("b", "implicability", &[], OfElements(MassFunction::implicability)),
    op("betp", "pignistic probability", &[], Probability(betp)),
    op("dsmp", "DSmP", &[EPSILON], Probability(dsmp)),
    op(
        "plausibility_transform",
        "plausibilities of the regions, scaled to sum to 1",
        &[],
        Probability(plp),
    ),
    op("betp_region", "pignistic probability of single Venn regions", &[], OfRegions(betp)),
    op("dsmp_region", "DSmP of single Venn regions", &[EPSILON], OfRegions(dsmp)),
    op("plausibility_transform_region", "the same of single Venn regions", &[], OfRegions(plp)),
    op(
        "cardinality",
        "Venn regions of each element",
        &[],
        Other(|case| {
            case.without_sources()?;
            each(case, |a| f64::from(a.cardinality()))
        }),
    ),
    op(
        "hyper_power_size",
        "elements of the (hyper-)power set",
        &[],
        Other(|case| {
            case.without_sources()?;
            Ok(Answer::Scalar(case.frame.element_count() as f64))
        }),
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
    op("auto_conflict", "K of so many copies of the source", &[ORDER], Other(auto_conflict)),
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
        "information content of DSmP",
        &[EPSILON],
        Other(|case| Ok(Answer::Scalar(dsmp(case, &case.only_source()?)?.information_content()))),
    ),
    op(
        "decide",
        "the best of the elements asked for, and those as good",
        &[
            param("criterion", CRITERIA),
            param("epsilon", "number of at least 0, with dsmp"),
            param("alpha", "number in [0, 1], with hurwicz"),
        ],
        Other(decide),
    ),
];

const CRITERIA: &str = "bel, pl, betp, dsmp or hurwicz";

const fn op(
    name: &'static str,
    summary: &'static str,
    params: &'static [Param],
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

fn uncertainty(case: &Case) -> Result<Uncertainty, CaseError> {
    let reliability = case.number(RELIABILITY.name)?;
    Uncertainty::new(1.0 - reliability).map_err(|_| {
        CaseError::parameter(format!("params.reliability is {reliability}; it lies in [0, 1]"))
    })
}

fn discount(case: &Case) -> Result<Answer, CaseError> {
    let u = uncertainty(case)?;
    masses(case, &case.only_source()?.discounted(u, &case.frame))
}

fn auto_conflict(case: &Case) -> Result<Answer, CaseError> {
    let order = case.number(ORDER.name)?;
    if order.fract() != 0.0 || !(1.0..=f64::from(MAX_ORDER)).contains(&order) {
        return Err(CaseError::parameter(format!(
            "params.order is {order}; expected a whole number from 1 to {MAX_ORDER}"
        )));
    }
    Ok(Answer::Scalar(case.only_source()?.auto_conflict(order as u32)?))
}

/// The best of the elements asked for and its equals, each with what the criterion says of the best.
fn decide(case: &Case) -> Result<Answer, CaseError> {
    let name = case.text("criterion", CRITERIA)?;
    let (criterion, known): (_, &[&str]) = match name {
        "bel" => (Criterion::Belief, &["criterion"]),
        "pl" => (Criterion::Plausibility, &["criterion"]),
        "betp" => (Criterion::Pignistic, &["criterion"]),
        "dsmp" => {
            let epsilon = case.number("epsilon")?;
            (Criterion::Dsmp { epsilon }, &["criterion", "epsilon"])
        }
        "hurwicz" => {
            let pessimism = case.number("alpha")?;
            if !(0.0..=1.0).contains(&pessimism) {
                let message = format!("params.alpha is {pessimism}; it lies in [0, 1]");
                return Err(CaseError::parameter(message));
            }
            (Criterion::Hurwicz { pessimism }, &["criterion", "alpha"])
        }
        _ => return Err(Case::wrong("criterion", &Value::from(name), CRITERIA)),
    };
    check_params(case, known)?;
    let asked = case.asked()?;
    let alternatives: Vec<Element> = asked.iter().map(|&(_, element)| element).collect();
    let choice = case.only_source()?.decide(&alternatives, criterion, &case.frame)?;
    let best = iter::once(choice.index).chain(choice.ties);
    Ok(Answer::Values(best.map(|place| (asked[place].0.clone(), choice.value)).collect()))
}

/// An operation as it is listed.
pub(super) struct Listed {
    pub(super) name: String,
    summary: &'static str,
    params: &'static [Param],
    is_rule: bool,
}

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, summary, params, is_rule } = self;
        write!(f, "{name:29} {summary}")?;
        for Param { name, what } in *params {
            write!(f, "; params.{name}: {what}")?;
        }
        if *is_rule { write!(f, "; also {name}{SEQUENTIAL}") } else { Ok(()) }
    }
}

/// All operations, rules first.
pub(super) fn list() -> impl Iterator<Item = Listed> {
    let rules = Rule::ALL.into_iter().map(|rule| {
        let (name, summary, params) = (rule_name(rule), rule.summary(), rule_params(rule));
        Listed { name, summary, params, is_rule: true }
    });
    rules.chain(OPERATIONS.iter().map(|&Operation { name, summary, params, .. }| Listed {
        name: name.to_owned(),
        summary,
        params,
        is_rule: false,
    }))
}

/// What a case calls a rule.
pub(crate) fn rule_name(rule: Rule) -> String {
    rule.name().replace('-', "_")
}

/// The parameters that a rule knows.
pub(crate) fn rule_params(rule: Rule) -> &'static [Param] {
    const K: Param = param("k", "number of at least 0");
    const WEIGHTS: Param =
        param("weights", "list of numbers of at least 0, one a source (optional)");
    match rule {
        Rule::Inagaki => &[K],
        Rule::Average => &[WEIGHTS],
        _ => &[],
    }
}

/// After the name of a rule: two sources at a time.
const SEQUENTIAL: &str = "_sequential";

/// Answers a case.
pub(super) fn answer(case: &Case) -> Result<Answer, CaseError> {
    if let Some(operation) = OPERATIONS.iter().find(|operation| operation.name == case.rule) {
        check_params(case, &names(operation.params))?;
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
    let (name, sequential) = match case.rule.strip_suffix(SEQUENTIAL) {
        Some(name) => (name, true),
        None => (case.rule.as_str(), false),
    };
    let Ok(rule) = name.parse::<Rule>() else {
        let (rule, known) = (&case.rule, Rule::ALL.map(rule_name).join(", "));
        let message = format!(
            "rule `{rule}` is unknown; known: {known} and others, see `wisdom combine --operations`"
        );
        return Err(CaseError { code: "unknown_rule", message });
    };
    combination(case, rule, sequential)
}

fn combination(case: &Case, rule: Rule, sequential: bool) -> Result<Answer, CaseError> {
    check_params(case, &names(rule_params(rule)))?;
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
    let fused = combine(rule, case.sources()?, &case.frame, &settings)?;
    masses(case, &fused)
}

fn reassign(case: &Case) -> Result<Answer, CaseError> {
    let given_on = case.source_frame.as_ref().unwrap_or(&case.frame);
    let (from, to) = (case.element("from", given_on)?, case.element("to", given_on)?);
    let sources = case.sources()?;
    let [source] = sources else { return Err(case.source_count(sources.len(), "1")) };
    let moved = source.mass(from);
    let kept = source.focal().iter().filter(|&&(element, _)| element != from && element != to);
    let masses_after =
        kept.copied().chain([(to, if from == to { moved } else { source.mass(to) + moved })]);
    let after = MassFunction::new(given_on, masses_after)?;
    masses(case, &case.frame.translate_mass(given_on, &after)?)
}

fn names(params: &[Param]) -> Vec<&'static str> {
    params.iter().map(|param| param.name).collect()
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
        let names: Vec<String> = list().map(|operation| operation.name).collect();
        let distinct: BTreeSet<&String> = names.iter().collect();
        assert_eq!(distinct.len(), names.len());
        assert!(names.len() > 60);
    }
}
