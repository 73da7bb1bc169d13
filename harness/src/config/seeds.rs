//! Lists of seeds: `0..7`, `0,3`, `0..3,10`.

use guard::text::short;

use super::count;

/// Parses a list of seeds: numbers and half-open ranges (`0..7` is 0 to 6), separated by commas.
///
/// # Errors
/// A message saying what is accepted, for anything else, for empty ranges and for a seed named twice.
pub fn parse(text: &str) -> Result<Vec<u64>, String> {
    let mut seeds = Vec::new();
    for part in text.split(',').map(str::trim) {
        let told = short(part);
        let bad = || format!("`{told}` is not a seed; accepted: numbers and ranges such as `0..7` or `0,3`");
        match part.split_once("..") {
            Some((from, to)) => {
                let from = count::parse(from).ok_or_else(bad)?;
                let to = count::parse(to).ok_or_else(bad)?;
                if from >= to {
                    return Err(format!("the range `{told}` is empty; `0..7` means the seeds 0 to 6"));
                }
                // Counted before it is built.
                check_number((to - from).saturating_add(seeds.len() as u64))?;
                seeds.extend(from..to);
            }
            None => seeds.push(count::parse(part).ok_or_else(bad)?),
        }
    }
    unique(&seeds)?;
    Ok(seeds)
}

/// More seeds than this, in all ranges together, are a slip of the keyboard.
const MOST_SEEDS: u64 = 10_000;

fn check_number(seeds: u64) -> Result<(), String> {
    if seeds > MOST_SEEDS {
        return Err(format!("{seeds} seeds or more; at most {MOST_SEEDS} are accepted"));
    }
    Ok(())
}

/// Refuses a seed that is named twice, one that no document can hold, and more seeds than anybody means.
///
/// # Errors
/// A message naming it, or the number.
pub fn unique(seeds: &[u64]) -> Result<(), String> {
    check_number(seeds.len() as u64)?;
    // A copy of the protocol has to hold them.
    if let Some(seed) = seeds.iter().find(|&&seed| i64::try_from(seed).is_err()) {
        return Err(format!("seed {seed} is larger than {}, the largest number of TOML", i64::MAX));
    }
    let mut sorted = seeds.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("seed {} is named twice", pair[0])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_half_open_and_lists_join() {
        assert_eq!(parse("0..7"), Ok(vec![0, 1, 2, 3, 4, 5, 6]));
        assert_eq!(parse("0,3"), Ok(vec![0, 3]));
        assert_eq!(parse("0..2, 10"), Ok(vec![0, 1, 10]));
        assert_eq!(parse("9223372036854775807"), Ok(vec![i64::MAX as u64]));
        assert_eq!(parse(" 1 .. 3 , 1_000, 2e3"), Ok(vec![1, 2, 1000, 2000]));
    }

    #[test]
    fn anything_else_says_what_is_accepted() {
        for bad in [
            "9223372036854775808",
            "18446744073709551615",
            "",
            "a",
            "3..1",
            "1..1",
            "0..",
            "-1",
            "0,0",
            "0..99999999999",
            "0..10000,10000..10001",
        ] {
            let error = parse(bad).expect_err(bad);
            assert!(!error.is_empty(), "{bad}");
        }
        assert!(parse("0-7").expect_err("dash").contains("`0..7`"));
    }
}
