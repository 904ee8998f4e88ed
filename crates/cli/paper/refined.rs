//! Equations 6 to 9: Dempster's rule on the refined frame does what DSmC does on the free one.

use wisdom_belief::{BeliefError, Element, Frame, InterestMass, MassFunction, Model, Rule, rule};

use super::check::{Against, Check};
use super::tables::EXACT;

/// The checks, on the sources of Table 6.
pub(super) fn checks(table_6: &[InterestMass; 3]) -> Result<Vec<Check>, BeliefError> {
    let free = Frame::interest(Model::Free)?;
    let refined = free.refined(["X", "Y", "Z"])?;
    let (i, ni) = (free.parse("I")?, free.parse("NI")?);
    let theta_ref = refined.frame();
    // The paper's elements on both frames, as its Eq. 6 pairs them.
    let pairs = [
        ("m(I ∩ NI)", i & ni, "m'(X)", theta_ref.parse("X")?),
        ("m(I)", i, "m'(X ∪ Y)", theta_ref.parse("X | Y")?),
        ("m(NI)", ni, "m'(X ∪ Z)", theta_ref.parse("X | Z")?),
        ("m(I ∪ NI)", i | ni, "m'(X ∪ Y ∪ Z)", theta_ref.parse("X | Y | Z")?),
    ];
    let mut checks = Vec::new();

    let group = "The refined frame: its elements must exclude each other";
    let shared = |a: Element, b: Element| (a & b).cardinality() as usize;
    let none = Against::Printed { value: 0.0, within: 0.0 };
    let x = theta_ref.parse("X")?;
    let astray = pairs.iter().filter(|&&(_, element, _, there)| refined.element(element) != there);
    let name = "elements that Eq. 6 pairs otherwise, Y = I \\ X and Z = NI \\ X";
    checks.push(Check::count(group, name, astray.count(), none));
    // As printed, with unions: Y = I ∪ (I ∩ NI) = I and Z = NI.
    let [union_y, union_z] = [i | (i & ni), ni | (i & ni)];
    for (name, a, b) in
        [("X and Y", i & ni, union_y), ("X and Z", i & ni, union_z), ("Y and Z", union_y, union_z)]
    {
        let name = format!("parts shared by {name}, with the unions as printed");
        checks.push(Check::count(group, name, shared(a, b), Against::Nothing));
    }

    let sources = table_6.map(|source| source.mass_function(&free));
    let [gradient, texture, temperature] = sources;
    let sources = [("gradient", gradient?), ("texture", texture?), ("temperature", temperature?)];
    let primed = sources.each_ref().map(|(_, source)| refined.mass(source));

    let group = "Eq. 6: the sources of Table 6 on the refined frame";
    for ((expert, source), primed) in sources.iter().zip(&primed) {
        for (plain, element, prime, refined) in pairs {
            let name = format!("{expert}: {prime} = {plain}");
            let check =
                Check::printed(group, name, primed.mass(refined), source.mass(element), 0.0);
            checks.push(check.decimals(6));
        }
        let paired = |element| pairs.iter().any(|&(.., refined)| refined == element);
        let others = primed.focal().iter().filter(|&&(element, _)| !paired(element)).count();
        checks.push(Check::count(group, format!("{expert}: other focal elements"), others, none));
    }

    let group = "Eq. 7: nothing conflicts, so that the denominator is 1";
    let duos = [(0, 1), (0, 2), (1, 2)];
    for (a, b) in duos {
        let duo = [primed[a].clone(), primed[b].clone()];
        let name = format!("{} and {}", sources[a].0, sources[b].0);
        let denominator = 1.0 - rule::conflict(&duo, theta_ref)?;
        checks.push(Check::printed(group, name, denominator, 1.0, 0.0));
    }
    let denominator = 1.0 - rule::conflict(&primed, theta_ref)?;
    checks.push(Check::printed(group, "all three", denominator, 1.0, 0.0));

    let group = "Eqs. 8 and 9: Dempster's rule on the refined frame, DSmC on the free one";
    let both = |some: &[usize]| -> Result<(MassFunction, MassFunction), BeliefError> {
        let there: Vec<_> = some.iter().map(|&s| primed[s].clone()).collect();
        let here: Vec<_> = some.iter().map(|&s| sources[s].1.clone()).collect();
        Ok((
            rule::combine(Rule::Dempster, &there, theta_ref)?,
            rule::combine(Rule::Dsmc, &here, &free)?,
        ))
    };
    for (a, b) in duos {
        let (eq_8, eq_9) = both(&[a, b])?;
        let name = format!("{} and {}: m'12(X) = m12(I ∩ NI)", sources[a].0, sources[b].0);
        let check = Check::printed(group, name, eq_8.mass(x), eq_9.mass(i & ni), EXACT);
        checks.push(check.decimals(8));
    }
    let (detour, direct) = both(&[0, 1, 2])?;
    for (plain, element, prime, refined) in pairs {
        let name = format!("all three: {prime} = {plain}");
        let check = Check::printed(group, name, detour.mass(refined), direct.mass(element), EXACT);
        checks.push(check.decimals(8));
    }
    Ok(checks)
}
