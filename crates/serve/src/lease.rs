//! Who drives a robot: at most one at a time, by a lease that ends with its connection or its time.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use chrono::{SecondsFormat, TimeDelta, Utc};
use serde::Serialize;

use crate::locked;
use crate::problem::{Kind, Problem};

/// Who drives, as everybody may see it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Driver {
    /// Who that is.
    pub(crate) client: String,
    /// When the lease ends; with its connection where that is not known.
    pub(crate) until: Option<String>,
}

/// The right to drive, which the word gives to whoever knows it.
#[derive(Clone, Debug)]
pub(crate) struct Lease {
    /// The word.
    pub(crate) word: String,
    /// Who has it.
    pub(crate) driver: Driver,
    ends: Option<Instant>,
}

/// What a lease is wanted for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wish<'a> {
    /// Who wants to drive.
    pub(crate) client: &'a str,
    /// Whether to take over from who drives.
    pub(crate) force: bool,
    /// The word of a lease that is to be renewed.
    pub(crate) word: Option<&'a str>,
    /// How long it lasts; as long as a connection, if `None`.
    pub(crate) lasts: Option<Duration>,
}

/// The lease of a robot.
#[derive(Debug, Default)]
pub(crate) struct Leases(Mutex<Option<Lease>>);

impl Leases {
    /// Gives the right to drive, or renews it.
    pub(crate) fn acquire(&self, wish: &Wish) -> Result<Lease, Problem> {
        let mut held = locked(&self.0);
        let (ends, until) = match wish.lasts {
            Some(lasts) => {
                let until = Utc::now() + TimeDelta::from_std(lasts).unwrap_or_default();
                (Instant::now().checked_add(lasts), Some(until.to_rfc3339_opts(SecondsFormat::Millis, true)))
            }
            None => (None, None),
        };
        let current = held.as_mut().filter(|lease| !lease.is_over());
        if let Some(lease) = current {
            if wish.word.is_some_and(|word| lease.word == word) {
                (lease.ends, lease.driver.until) = (ends, until);
                return Ok(lease.clone());
            }
            if !wish.force {
                return Err(driven(&lease.driver));
            }
        }
        let lease = Lease { word: random_word()?, driver: Driver { client: wish.client.to_owned(), until }, ends };
        Ok(held.insert(lease).clone())
    }

    /// Gives it back. Returns whether that was the lease.
    pub(crate) fn release(&self, word: &str) -> bool {
        locked(&self.0).take_if(|lease| lease.word == word).is_some()
    }

    /// Who asks so.
    pub(crate) fn holder(&self, word: &str) -> Result<String, Problem> {
        match locked(&self.0).as_ref().filter(|lease| !lease.is_over()) {
            Some(lease) if lease.word == word => Ok(lease.driver.client.clone()),
            Some(lease) => Err(driven(&lease.driver)),
            None => Err(Problem::new(Kind::NoLease, "the lease has ended")),
        }
    }

    /// Who drives now, and a number that is another one for each lease.
    pub(crate) fn driver(&self) -> Option<Driver> {
        let mut held = locked(&self.0);
        held.take_if(|lease| lease.is_over());
        held.as_ref().map(|lease| lease.driver.clone())
    }
}

impl Lease {
    /// By a clock that is never set.
    fn is_over(&self) -> bool {
        self.ends.is_some_and(|ends| ends <= Instant::now())
    }
}

fn driven(driver: &Driver) -> Problem {
    Problem::new(Kind::Driven, format!("{} drives it; `force` takes over", driver.client))
}

/// One that nobody can guess.
fn random_word() -> Result<String, Problem> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| Problem::new(Kind::Overload, format!("no random number: {error}")))?;
    Ok(format!("{:032x}", u128::from_ne_bytes(bytes)))
}

#[cfg(test)]
mod tests {
    use super::{Duration, Leases, Wish};

    const ANNA: Wish = Wish { client: "anna", force: false, word: None, lasts: None };
    const BERT: Wish = Wish { client: "bert", ..ANNA };

    #[test]
    fn one_drives_until_it_is_over_or_taken() {
        let leases = Leases::default();
        let lease = leases.acquire(&ANNA).unwrap();
        assert!(leases.acquire(&BERT).unwrap_err().detail.contains("anna"));
        assert_eq!(leases.holder(&lease.word).unwrap(), "anna");
        let renewed = leases.acquire(&Wish { word: Some(&lease.word), ..ANNA }).unwrap();
        assert_eq!(renewed.word, lease.word);
        let taken = leases.acquire(&Wish { force: true, ..BERT }).unwrap();
        assert!(leases.holder(&lease.word).is_err() && !leases.release(&lease.word));
        assert_eq!(leases.driver().unwrap().client, "bert");
        assert!(leases.release(&taken.word) && leases.driver().is_none());

        let over = leases.acquire(&Wish { lasts: Some(Duration::ZERO), ..ANNA }).unwrap();
        assert!(leases.holder(&over.word).is_err() && leases.driver().is_none());
        assert!(leases.acquire(&BERT).is_ok());
    }
}
