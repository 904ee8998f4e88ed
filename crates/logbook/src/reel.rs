//! A plane of one decision after the other, from a log that may hold only what changed.

use wisdom_grid::Raster;

use crate::{LogError, LogReader, topic};

/// Goes through a log's maps of one plane in the order of the decisions. A whole map is read at most once.
#[derive(Debug, Clone)]
pub struct Reel {
    whole: String,
    patch: String,
    next: u32,
    known: Option<Raster<f32>>,
}

impl Default for Reel {
    fn default() -> Self {
        Self::new()
    }
}

impl Reel {
    /// A reel of the interest before the first decision.
    #[must_use]
    pub fn new() -> Self {
        Self::of("interest")
    }

    /// A reel of a plane, by its name.
    #[must_use]
    pub fn of(plane: &str) -> Self {
        Self { whole: topic::map_of(plane), patch: topic::patch_of(plane), next: 0, known: None }
    }

    /// The plane at a decision as the log tells it; none if it tells of none. Turned back, it begins anew.
    ///
    /// # Errors
    /// As [`LogReader::map`]; [`LogError::Malformed`] if a patch lies where no map is.
    pub fn turn_to(
        &mut self,
        log: &LogReader,
        decision: u32,
    ) -> Result<Option<&Raster<f32>>, LogError> {
        if decision < self.next {
            (self.next, self.known) = (0, None);
        }
        // What comes before the last whole map need not be read.
        let from = log.decisions_with(&self.whole, self.next..=decision).next_back();
        if let Some(from) = from {
            self.known = Some(log.map(&self.whole, from)?);
            self.next = from + 1;
        }
        for at in log.decisions_with(&self.patch, self.next..=decision) {
            let patch = log.map(&self.patch, at)?;
            let fits = |known: &Raster<f32>| known.spec().part(patch.spec().window()).is_ok();
            let Some(known) = self.known.as_mut().filter(|known| fits(known)) else {
                return Err(LogError::Malformed {
                    record: format!("{} of decision {at}", self.patch),
                    field: "pose.position".to_owned(),
                    found: patch.spec().window().to_string(),
                    limit: "a part of the map before it",
                });
            };
            for (cell, value) in patch.iter() {
                known[cell] = *value;
            }
        }
        self.next = decision + 1;
        Ok(self.known.as_ref())
    }
}

impl LogReader {
    /// The interest map of a decision, put together from the whole map before it and what changed since; none if the log
    /// holds no maps.
    ///
    /// # Errors
    /// As [`Reel::turn_to`].
    pub fn interest(&self, decision: u32) -> Result<Option<Raster<f32>>, LogError> {
        let mut reel = Reel::new();
        Ok(reel.turn_to(self, decision)?.cloned())
    }
}
