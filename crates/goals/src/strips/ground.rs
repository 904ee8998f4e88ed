//! Typed objects and operators with parameters, and their grounding: every operator for every choice of objects of the
//! right types, less what can never matter (as planners of PDDL do; Helmert 2009).

use std::collections::{BTreeMap, BTreeSet};

use super::{DRIVE, OperatorText};

/// The most ground operators that the parameters may stand for.
pub const MAX_GROUND: usize = 10_000;

/// The type that all objects have.
const OBJECT: &str = "object";

/// A type as a file names it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TypeText {
    /// Name, unique among the types.
    pub name: String,
    /// The type it is a kind of; `object` if none is named.
    pub parent: Option<String>,
}

/// An object as a file names it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ObjectText {
    /// Name, unique among the objects.
    pub name: String,
    /// Its type.
    pub kind: String,
}

/// An operator with parameters, as a file names it. Its facts are atoms such as `calibrated(?i)`: a predicate with
/// parameters or objects as arguments; without arguments, the predicate alone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SchemaText {
    /// Parameters with their types: `?i - instrument`, or `?i` for any object.
    pub parameters: Vec<String>,
    /// The operator over them.
    pub operator: OperatorText,
}

/// Where in a domain's text a mistake is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum GroundPlace {
    /// The name of a type, by index.
    Type(usize),
    /// The parent of a type, by index.
    Parent(usize),
    /// The name of an object, by index.
    Object(usize),
    /// The type of an object, by index.
    Kind(usize),
    /// A fact that holds at first, by index.
    Fact(usize),
    /// A part of an operator, by index.
    Operator(usize, OperatorPart),
}

/// A part of an operator's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OperatorPart {
    /// Its name.
    Name,
    /// Its parameters.
    Parameters,
    /// Its preconditions.
    Preconditions,
    /// Its add list.
    Adds,
    /// Its delete list.
    Deletes,
}

/// A mistake in a domain with types, and where it is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{fault}")]
pub struct GroundError {
    /// Where.
    pub place: GroundPlace,
    /// What.
    pub fault: GroundFault,
}

/// What is wrong in a domain with types.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GroundFault {
    /// A name has characters that facts are written with.
    #[error("`{name}`; expected a name without spaces, `(`, `)`, `,` and `?`")]
    Name {
        /// The name found.
        name: String,
    },
    /// Two things of one sort share a name.
    #[error("a second {what} is named `{name}`")]
    Twice {
        /// What is named so.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A type that is not declared.
    #[error("`{name}` is no type; there are {known}")]
    UnknownType {
        /// The name found.
        name: String,
        /// The types declared.
        known: String,
    },
    /// A type that is a kind of itself.
    #[error(
        "type `{name}` is a kind of itself: {cycle}; expected a parent that leads up to `object`"
    )]
    CyclicType {
        /// The type.
        name: String,
        /// The way round.
        cycle: String,
    },
    /// An object that is not declared.
    #[error("`{name}` in `{atom}` is no object; there are {known}")]
    UnknownObject {
        /// The name found.
        name: String,
        /// Where it is used.
        atom: String,
        /// The objects declared.
        known: String,
    },
    /// Text that is no fact.
    #[error("`{atom}`; expected a fact such as `stowed` or `calibrated(apxs)`")]
    Atom {
        /// The text found.
        atom: String,
    },
    /// Text that is no parameter.
    #[error("`{parameter}`; expected a parameter such as `?i - instrument`")]
    Parameter {
        /// The text found.
        parameter: String,
    },
    /// A variable that is none of the parameters.
    #[error("`{variable}` in `{atom}` is bound by no parameter; there are {known}")]
    Unbound {
        /// The variable.
        variable: String,
        /// Where it is used.
        atom: String,
        /// The parameters.
        known: String,
    },
    /// A parameter that no fact of the operator mentions: its copies would all be the same.
    #[error("parameter `{variable}` is in no fact of the operator; expected each to be used")]
    Unused {
        /// The parameter.
        variable: String,
    },
    /// A predicate with more or fewer arguments than elsewhere.
    #[error("`{atom}` has {found} arguments; `{predicate}` has {expected} elsewhere")]
    Arity {
        /// The fact.
        atom: String,
        /// Its predicate.
        predicate: String,
        /// Arguments found.
        found: usize,
        /// Arguments it has where it is mentioned first.
        expected: usize,
    },
    /// An object in a place where operators speak of another type.
    #[error("`{object}` in `{atom}` is of type `{kind}`; operators have `{expected}` there")]
    WrongType {
        /// The object.
        object: String,
        /// The fact.
        atom: String,
        /// Its type.
        kind: String,
        /// The types that operators have there.
        expected: String,
    },
    /// The drive has parameters.
    #[error("operator `drive` has parameters; there is one drive, and its route is the planner's")]
    DriveParameters,
    /// More ground operators than [`MAX_GROUND`].
    #[error(
        "with this operator there are {found} ground operators; at most {MAX_GROUND} are possible"
    )]
    TooMany {
        /// How many there would be.
        found: usize,
    },
    /// No choice of objects makes the operator possible.
    #[error("no choice of objects makes it possible; `{fact}` is never made true, say")]
    Never {
        /// A precondition of the first choice that no reachable state holds.
        fact: String,
    },
    /// There is no object for a parameter.
    #[error("no object is of type `{kind}`, for parameter `{variable}`; expected at least one")]
    NoObject {
        /// The parameter.
        variable: String,
        /// Its type.
        kind: String,
    },
}

/// A predicate and its arguments.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Atom {
    predicate: String,
    arguments: Vec<String>,
}

impl Atom {
    /// `predicate`, or `predicate(argument, …)`.
    fn parse(text: &str) -> Result<Self, GroundFault> {
        let fault = || GroundFault::Atom { atom: text.to_owned() };
        let Some((predicate, rest)) = text.split_once('(') else {
            let is_plain = !text.is_empty() && !text.contains([')', ',', '?']);
            return is_plain
                .then(|| Self { predicate: text.to_owned(), arguments: Vec::new() })
                .ok_or_else(fault);
        };
        let inside = rest.trim_end().strip_suffix(')').ok_or_else(fault)?;
        let predicate = predicate.trim().to_owned();
        let arguments: Vec<String> = inside.split(',').map(|a| a.trim().to_owned()).collect();
        let is_argument = |a: &String| is_name(a.strip_prefix('?').unwrap_or(a));
        if !is_name(&predicate) || !arguments.iter().all(is_argument) {
            return Err(fault());
        }
        Ok(Self { predicate, arguments })
    }

    fn variables(&self) -> impl Iterator<Item = &str> {
        self.arguments.iter().map(String::as_str).filter(|a| a.starts_with('?'))
    }

    /// The name of the ground fact.
    fn bound(&self, binding: &BTreeMap<&str, &str>) -> String {
        let value =
            |a: &'_ String| binding.get(a.as_str()).map_or_else(|| a.clone(), |o| (*o).to_owned());
        applied(&self.predicate, &self.arguments.iter().map(value).collect::<Vec<_>>())
    }
}

/// `name`, or `name(a, b)`.
fn applied(name: &str, arguments: &[String]) -> String {
    if arguments.is_empty() { name.to_owned() } else { format!("{name}({})", arguments.join(", ")) }
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && !text.contains(|c: char| c.is_whitespace() || "(),?".contains(c))
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() { "none".into() } else { names.join(", ") }
}

/// A domain with types, objects and parameters, checked.
#[derive(Debug, Clone)]
pub struct Lifted {
    /// Each type and what it is a kind of, itself first.
    types: BTreeMap<String, Vec<String>>,
    /// Objects and their types, in the order of the file.
    objects: Vec<ObjectText>,
    /// Ground names of the facts that hold at first.
    facts: Vec<String>,
    schemas: Vec<Schema>,
    signatures: BTreeMap<String, Signature>,
}

/// What is known of a predicate: for each argument the types that operators have there.
type Signature = Vec<BTreeSet<String>>;

#[derive(Debug, Clone)]
struct Schema {
    text: OperatorText,
    /// Variables and their types.
    parameters: Vec<(String, String)>,
    preconditions: Vec<Atom>,
    adds: Vec<Atom>,
    deletes: Vec<Atom>,
}

impl Schema {
    fn parts(&self) -> [(OperatorPart, &[Atom]); 3] {
        [
            (OperatorPart::Preconditions, &self.preconditions),
            (OperatorPart::Adds, &self.adds),
            (OperatorPart::Deletes, &self.deletes),
        ]
    }
}

/// Operators without parameters, and what of the facts matters.
#[derive(Debug, Clone, PartialEq)]
pub struct Ground {
    /// The ground operators, such as `calibrate(apxs)`, in the order of the file and of the objects.
    pub operators: Vec<OperatorText>,
    /// For each of them the operator in the file it came from, by index.
    pub schema: Vec<usize>,
    /// The facts that hold at first.
    pub facts: Vec<String>,
}

/// One ground operator on the way.
struct Bound {
    schema: usize,
    name: String,
    preconditions: Vec<String>,
    adds: Vec<String>,
    deletes: Vec<String>,
}

impl Lifted {
    /// Checks types, objects, facts and operators against each other.
    ///
    /// A predicate need not be declared: it has as many arguments as where it is mentioned first, and each argument the
    /// types of the parameters that operators put there (any, if none does).
    ///
    /// # Errors
    /// A [`GroundError`] with the place of the first mistake.
    pub fn new(
        types: &[TypeText],
        objects: &[ObjectText],
        facts: &[String],
        operators: &[SchemaText],
    ) -> Result<Self, GroundError> {
        let mut lifted = Self {
            types: ancestries(types)?,
            objects: objects.to_vec(),
            facts: Vec::new(),
            schemas: Vec::new(),
            signatures: BTreeMap::new(),
        };
        for (i, object) in objects.iter().enumerate() {
            let at = |place, fault| Err(GroundError { place, fault });
            if !is_name(&object.name) {
                let fault = GroundFault::Name { name: object.name.clone() };
                return at(GroundPlace::Object(i), fault);
            }
            if objects[..i].iter().any(|o| o.name == object.name) {
                let fault = GroundFault::Twice { what: "object", name: object.name.clone() };
                return at(GroundPlace::Object(i), fault);
            }
            lifted
                .known_type(&object.kind)
                .map_err(|fault| GroundError { place: GroundPlace::Kind(i), fault })?;
        }
        for (i, operator) in operators.iter().enumerate() {
            let schema = lifted.schema(operator).map_err(|(part, fault)| GroundError {
                place: GroundPlace::Operator(i, part),
                fault,
            })?;
            lifted.schemas.push(schema);
        }
        // What an object may stand for is known once all operators have been read.
        for (i, schema) in lifted.schemas.iter().enumerate() {
            for (part, atoms) in schema.parts() {
                for atom in atoms {
                    lifted.check_objects(atom).map_err(|fault| GroundError {
                        place: GroundPlace::Operator(i, part),
                        fault,
                    })?;
                }
            }
        }
        for (i, fact) in facts.iter().enumerate() {
            let fact = lifted
                .fact(fact)
                .map_err(|fault| GroundError { place: GroundPlace::Fact(i), fault })?;
            lifted.facts.push(fact);
        }
        Ok(lifted)
    }

    /// The name of a ground fact as operators and states have it, if it fits the domain: `calibrated( apxs )` is
    /// `calibrated(apxs)`.
    ///
    /// # Errors
    /// A [`GroundFault`] for text that is no fact, an unknown object, one of a wrong type, or a wrong number of them.
    pub fn fact(&self, text: &str) -> Result<String, GroundFault> {
        let atom = Atom::parse(text)?;
        if let Some(variable) = atom.variables().next() {
            let known = listed(std::iter::empty());
            return Err(GroundFault::Unbound {
                variable: variable.into(),
                atom: text.into(),
                known,
            });
        }
        if let Some(signature) = self.signatures.get(&atom.predicate) {
            arity(&atom, signature.len())?;
        }
        self.check_objects(&atom)?;
        Ok(atom.bound(&BTreeMap::new()))
    }

    /// Every operator for every choice of objects of the right types, less those that no reachable state allows; of the
    /// facts those that some state can hold and that something (an operator, or `asked`) asks for, and that are not
    /// always true. `asked` are ground facts by the names that [`Lifted::fact`] gives.
    ///
    /// Operators without parameters stay, possible or not, so that what they lack is named when the domain is made.
    ///
    /// # Errors
    /// A [`GroundError`] if there are too many, or no choice of objects makes an operator possible.
    pub fn ground(&self, asked: &[String]) -> Result<Ground, GroundError> {
        let bound = self.bindings()?;
        let reachable = self.reachable(&bound);
        let is_possible =
            |o: &Bound| o.preconditions.iter().all(|fact| reachable.contains(fact.as_str()));
        for (i, schema) in self.schemas.iter().enumerate() {
            let mut own = bound.iter().filter(|o| o.schema == i).peekable();
            let missing = own
                .peek()
                .and_then(|o| o.preconditions.iter().find(|f| !reachable.contains(f.as_str())));
            if let Some(fact) = missing
                && !schema.parameters.is_empty()
                && !own.any(is_possible)
            {
                let place = GroundPlace::Operator(i, OperatorPart::Preconditions);
                let fault = GroundFault::Never { fact: fact.clone() };
                return Err(GroundError { place, fault });
            }
        }
        let kept: Vec<&Bound> = bound
            .iter()
            .filter(|o| self.schemas[o.schema].parameters.is_empty() || is_possible(o))
            .collect();
        let deleted: BTreeSet<&str> =
            kept.iter().flat_map(|o| &o.deletes).map(String::as_str).collect();
        let initial: BTreeSet<&str> = self.facts.iter().map(String::as_str).collect();
        let asked: BTreeSet<&str> = asked.iter().map(String::as_str).collect();
        let needed: BTreeSet<&str> =
            kept.iter().flat_map(|o| &o.preconditions).map(String::as_str).collect();
        let is_always = |fact: &str| initial.contains(fact) && !deleted.contains(fact);
        let matters =
            |fact: &str| asked.contains(fact) || needed.contains(fact) && !is_always(fact);
        let of = |facts: &[String]| -> Vec<String> {
            facts.iter().filter(|f| matters(f)).cloned().collect()
        };
        // A fact that an operator deletes and that nothing ever makes true is no change.
        let of_possible = |facts: &[String]| -> Vec<String> {
            of(facts).into_iter().filter(|f| reachable.contains(f.as_str())).collect()
        };
        let operators = kept.iter().map(|o| {
            let text = &self.schemas[o.schema].text;
            OperatorText {
                name: o.name.clone(),
                preconditions: of(&o.preconditions),
                adds: of(&o.adds),
                deletes: of_possible(&o.deletes),
                cost: text.cost,
            }
        });
        let is_idle = |o: &OperatorText| o.adds.is_empty() && o.deletes.is_empty();
        let (operators, schema) = operators
            .zip(kept.iter().map(|o| o.schema))
            .filter(|(o, i)| self.schemas[*i].parameters.is_empty() || !is_idle(o))
            .unzip();
        Ok(Ground { operators, schema, facts: of(&self.facts) })
    }

    /// All ground operators.
    fn bindings(&self) -> Result<Vec<Bound>, GroundError> {
        let mut all = Vec::new();
        for (i, schema) in self.schemas.iter().enumerate() {
            let error = |fault| GroundError {
                place: GroundPlace::Operator(i, OperatorPart::Parameters),
                fault,
            };
            let choices: Vec<Vec<&str>> = schema
                .parameters
                .iter()
                .map(|(_, kind)| {
                    let fits = self.objects.iter().filter(|o| self.is_a(&o.kind, kind));
                    fits.map(|o| o.name.as_str()).collect()
                })
                .collect();
            if let Some(empty) = choices.iter().position(Vec::is_empty) {
                let (variable, kind) = schema.parameters[empty].clone();
                return Err(error(GroundFault::NoObject { variable, kind }));
            }
            let count = choices.iter().fold(1usize, |n, c| n.saturating_mul(c.len()));
            let found = all.len().saturating_add(count);
            if found > MAX_GROUND {
                return Err(error(GroundFault::TooMany { found }));
            }
            for number in 0..count {
                let mut left = number;
                let mut objects = vec![""; choices.len()];
                // The last parameter changes fastest.
                for (object, choice) in objects.iter_mut().zip(&choices).rev() {
                    *object = choice[left % choice.len()];
                    left /= choice.len();
                }
                let binding: BTreeMap<&str, &str> = schema
                    .parameters
                    .iter()
                    .zip(&objects)
                    .map(|((variable, _), object)| (variable.as_str(), *object))
                    .collect();
                let of = |atoms: &[Atom]| atoms.iter().map(|a| a.bound(&binding)).collect();
                let objects: Vec<String> = objects.iter().map(ToString::to_string).collect();
                all.push(Bound {
                    schema: i,
                    name: applied(&schema.text.name, &objects),
                    preconditions: of(&schema.preconditions),
                    adds: of(&schema.adds),
                    deletes: of(&schema.deletes),
                });
            }
        }
        Ok(all)
    }

    /// The facts that some state may hold, if nothing were ever deleted.
    fn reachable<'a>(&'a self, operators: &'a [Bound]) -> BTreeSet<&'a str> {
        let mut reachable: BTreeSet<&str> = self.facts.iter().map(String::as_str).collect();
        let mut waiting: Vec<&Bound> = operators.iter().collect();
        loop {
            let before = waiting.len();
            waiting.retain(|o| {
                let ready = o.preconditions.iter().all(|f| reachable.contains(f.as_str()));
                if ready {
                    reachable.extend(o.adds.iter().map(String::as_str));
                }
                !ready
            });
            if waiting.len() == before {
                return reachable;
            }
        }
    }

    /// Whether objects of one type are of the other.
    fn is_a(&self, kind: &str, wanted: &str) -> bool {
        wanted == OBJECT || self.types.get(kind).is_some_and(|up| up.iter().any(|t| t == wanted))
    }

    fn known_type(&self, name: &str) -> Result<(), GroundFault> {
        if name == OBJECT || self.types.contains_key(name) {
            return Ok(());
        }
        let known = listed([OBJECT].into_iter().chain(self.types.keys().map(String::as_str)));
        Err(GroundFault::UnknownType { name: name.to_owned(), known })
    }

    fn schema(&mut self, text: &SchemaText) -> Result<Schema, (OperatorPart, GroundFault)> {
        let SchemaText { parameters, operator } = text;
        let mut bound: Vec<(String, String)> = Vec::new();
        for parameter in parameters {
            let fault = |fault| (OperatorPart::Parameters, fault);
            // A name may have a hyphen: what parts it from its type has a space on both sides.
            let (variable, kind) = parameter.split_once(" - ").unwrap_or((parameter, OBJECT));
            let (variable, kind) = (variable.trim(), kind.trim());
            if !variable.strip_prefix('?').is_some_and(is_name) || !is_name(kind) {
                return Err(fault(GroundFault::Parameter { parameter: parameter.clone() }));
            }
            self.known_type(kind).map_err(fault)?;
            if bound.iter().any(|(v, _)| v == variable) {
                let name = variable.to_owned();
                return Err(fault(GroundFault::Twice { what: "parameter", name }));
            }
            bound.push((variable.to_owned(), kind.to_owned()));
        }
        if !bound.is_empty() && operator.name == DRIVE {
            return Err((OperatorPart::Parameters, GroundFault::DriveParameters));
        }
        if !bound.is_empty() && !is_name(&operator.name) {
            let name = operator.name.clone();
            return Err((OperatorPart::Name, GroundFault::Name { name }));
        }
        let mut read = |part, atoms: &[String]| {
            let atoms = atoms.iter().map(|atom| self.atom(atom, &bound));
            atoms.collect::<Result<Vec<_>, _>>().map_err(|fault| (part, fault))
        };
        let schema = Schema {
            text: operator.clone(),
            preconditions: read(OperatorPart::Preconditions, &operator.preconditions)?,
            adds: read(OperatorPart::Adds, &operator.adds)?,
            deletes: read(OperatorPart::Deletes, &operator.deletes)?,
            parameters: bound,
        };
        let is_used = |variable: &str| {
            schema
                .parts()
                .iter()
                .any(|(_, atoms)| atoms.iter().any(|atom| atom.variables().any(|v| v == variable)))
        };
        if let Some((variable, _)) = schema.parameters.iter().find(|(v, _)| !is_used(v)) {
            let fault = GroundFault::Unused { variable: variable.clone() };
            return Err((OperatorPart::Parameters, fault));
        }
        Ok(schema)
    }

    /// An atom of an operator, whose types join the signature of its predicate.
    fn atom(&mut self, text: &str, parameters: &[(String, String)]) -> Result<Atom, GroundFault> {
        let atom = Atom::parse(text)?;
        let signature = self
            .signatures
            .entry(atom.predicate.clone())
            .or_insert_with(|| vec![BTreeSet::new(); atom.arguments.len()]);
        arity(&atom, signature.len())?;
        for (place, argument) in signature.iter_mut().zip(&atom.arguments) {
            if !argument.starts_with('?') {
                continue;
            }
            let Some((_, kind)) = parameters.iter().find(|(v, _)| v == argument) else {
                return Err(GroundFault::Unbound {
                    variable: argument.clone(),
                    atom: text.to_owned(),
                    known: listed(parameters.iter().map(|(v, _)| v.as_str())),
                });
            };
            place.insert(kind.clone());
        }
        Ok(atom)
    }

    /// The objects of an atom exist and are of a type that operators have there.
    fn check_objects(&self, atom: &Atom) -> Result<(), GroundFault> {
        for (i, argument) in atom.arguments.iter().enumerate() {
            if argument.starts_with('?') {
                continue;
            }
            let text = || applied(&atom.predicate, &atom.arguments);
            let Some(object) = self.objects.iter().find(|o| o.name == *argument) else {
                return Err(GroundFault::UnknownObject {
                    name: argument.clone(),
                    atom: text(),
                    known: listed(self.objects.iter().map(|o| o.name.as_str())),
                });
            };
            let Some(kinds) = self.signatures.get(&atom.predicate).map(|s| &s[i]) else { continue };
            if !kinds.is_empty() && !kinds.iter().any(|kind| self.is_a(&object.kind, kind)) {
                let expected: Vec<&str> = kinds.iter().map(String::as_str).collect();
                return Err(GroundFault::WrongType {
                    object: argument.clone(),
                    atom: text(),
                    kind: object.kind.clone(),
                    expected: expected.join("` or `"),
                });
            }
        }
        Ok(())
    }
}

fn arity(atom: &Atom, expected: usize) -> Result<(), GroundFault> {
    let found = atom.arguments.len();
    if found == expected {
        return Ok(());
    }
    let atom_text = applied(&atom.predicate, &atom.arguments);
    let predicate = atom.predicate.clone();
    Err(GroundFault::Arity { atom: atom_text, predicate, found, expected })
}

/// Each type with all that it is a kind of, itself first.
fn ancestries(types: &[TypeText]) -> Result<BTreeMap<String, Vec<String>>, GroundError> {
    let error = |place, fault| Err(GroundError { place, fault });
    for (i, kind) in types.iter().enumerate() {
        let name = || kind.name.clone();
        if !is_name(&kind.name) {
            return error(GroundPlace::Type(i), GroundFault::Name { name: name() });
        }
        let is_second = kind.name == OBJECT || types[..i].iter().any(|t| t.name == kind.name);
        if is_second {
            let fault = GroundFault::Twice { what: "type", name: name() };
            return error(GroundPlace::Type(i), fault);
        }
    }
    let mut ancestries = BTreeMap::new();
    for (i, kind) in types.iter().enumerate() {
        let mut up = vec![kind.name.clone()];
        let mut at = kind;
        while let Some(parent) = at.parent.as_deref().filter(|p| *p != OBJECT) {
            let Some(next) = types.iter().find(|t| t.name == parent) else {
                let known =
                    listed([OBJECT].into_iter().chain(types.iter().map(|t| t.name.as_str())));
                let wrong = types.iter().position(|t| t.name == at.name).unwrap_or(i);
                let fault = GroundFault::UnknownType { name: parent.to_owned(), known };
                return error(GroundPlace::Parent(wrong), fault);
            };
            let cyclic = up.contains(&next.name);
            up.push(next.name.clone());
            if cyclic {
                let fault =
                    GroundFault::CyclicType { name: kind.name.clone(), cycle: up.join(" < ") };
                return error(GroundPlace::Parent(i), fault);
            }
            at = next;
        }
        ancestries.insert(kind.name.clone(), up);
    }
    Ok(ancestries)
}
