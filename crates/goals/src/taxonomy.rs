//! Types of objects as a tree, and which class of the ground is of which type.

use std::collections::BTreeMap;

/// A tree of types: a ledge is a rock, a rock is an object.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Taxonomy {
    /// Names and parents (by index) of the types; a parent stands before its children.
    types: Vec<(String, Option<usize>)>,
    /// Type of each class of the ground.
    classes: BTreeMap<u16, usize>,
}

/// Why types are no tree.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TaxonomyError {
    /// A name is given twice.
    #[error("type `{name}` is given twice")]
    Repeated {
        /// The name.
        name: String,
    },
    /// A parent that stands nowhere above.
    #[error("type `{name}`: its parent `{parent}` is no type given before it")]
    Parent {
        /// The type.
        name: String,
        /// The parent asked for.
        parent: String,
    },
    /// A class of two types.
    #[error("class {class} is given to type `{name}` and to `{other}` before it")]
    Class {
        /// The class.
        class: u16,
        /// The type.
        name: String,
        /// The type that has it.
        other: String,
    },
}

impl Taxonomy {
    /// Adds a type below its parent, with the classes that are of it.
    ///
    /// # Errors
    /// [`TaxonomyError`] if the name or a class is given twice, or the parent is not there yet.
    pub fn add(
        &mut self,
        name: &str,
        parent: Option<&str>,
        classes: &[u16],
    ) -> Result<(), TaxonomyError> {
        let name = name.to_owned();
        if self.index(&name).is_some() {
            return Err(TaxonomyError::Repeated { name });
        }
        let above = match parent {
            None => None,
            Some(parent) => match self.index(parent) {
                Some(index) => Some(index),
                None => return Err(TaxonomyError::Parent { name, parent: parent.to_owned() }),
            },
        };
        for &class in classes {
            if let Some(&other) = self.classes.get(&class) {
                let other = self.types[other].0.clone();
                return Err(TaxonomyError::Class { class, name, other });
            }
        }
        self.classes.extend(classes.iter().map(|&class| (class, self.types.len())));
        self.types.push((name, above));
        Ok(())
    }

    /// Index of a type.
    #[must_use]
    pub fn index(&self, name: &str) -> Option<usize> {
        self.types.iter().position(|(known, _)| known == name)
    }

    /// Names of the types, parents before children.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.types.iter().map(|(name, _)| name.as_str())
    }

    /// The type of a class that is read with an uncertainty: its own where the reading is clearer than `clear_below`,
    /// else that of its parent, which is all that can be said; none where nothing was read or the class has no type.
    #[must_use]
    pub fn type_of(&self, class: u16, u: f64, clear_below: f64) -> Option<usize> {
        let own = *self.classes.get(&class)?;
        if u < clear_below {
            Some(own)
        } else if u < 1.0 {
            self.types[own].1
        } else {
            None
        }
    }

    /// Whether a type is of another: the same, or below it.
    #[must_use]
    pub fn is_of(&self, one: usize, other: usize) -> bool {
        let mut at = Some(one);
        while let Some(index) = at {
            if index == other {
                return true;
            }
            at = self.types[index].1;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rocks() -> Taxonomy {
        let mut tree = Taxonomy::default();
        tree.add("rock", None, &[]).unwrap();
        tree.add("ledge", Some("rock"), &[4]).unwrap();
        tree.add("bedrock", Some("rock"), &[3]).unwrap();
        tree
    }

    #[test]
    fn an_unclear_class_is_only_known_by_its_parent() {
        let tree = rocks();
        let name = |of: Option<usize>| of.and_then(|i| tree.names().nth(i));
        assert_eq!(name(tree.type_of(4, 0.1, 0.5)), Some("ledge"));
        assert_eq!(name(tree.type_of(4, 0.5, 0.5)), Some("rock"));
        assert_eq!(tree.type_of(4, 1.0, 0.5), None);
        assert_eq!(tree.type_of(1, 0.0, 0.5), None);
        assert!(tree.is_of(1, 0) && !tree.is_of(0, 1) && !tree.is_of(1, 2) && tree.is_of(2, 2));
    }

    #[test]
    fn types_that_are_no_tree_are_refused() {
        let mut tree = rocks();
        assert!(matches!(tree.add("rock", None, &[]), Err(TaxonomyError::Repeated { .. })));
        assert!(matches!(tree.add("sand", Some("soil"), &[]), Err(TaxonomyError::Parent { .. })));
        assert!(matches!(tree.add("sand", None, &[4]), Err(TaxonomyError::Class { class: 4, .. })));
    }
}
