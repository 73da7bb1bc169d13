//! Names of protocols. A name is also that of the results folder, letter for letter, so that two protocols
//! never share a folder by accident.

use reports::store::digest;
use toml::{Table, Value};

/// Most bytes of a name: file systems accept 255, and job arrays put a word before it.
const LONGEST: usize = 200;
/// Hex digits of the digest that ends a name which says less than everything.
const DIGITS: usize = 8;

/// Refuses a name that cannot be a folder's.
///
/// # Errors
/// A message saying what is accepted.
pub(super) fn check(name: &str) -> Result<(), String> {
    let wrong = |why: &str| {
        let accepted = "accepted: what a folder can be called, in any script";
        Err(format!("`{}` cannot be a name: {why}; {accepted}", name.escape_debug()))
    };
    if name.trim().is_empty() {
        return wrong("it is empty");
    }
    if name.trim() != name {
        return wrong("it begins or ends with a space");
    }
    if name.starts_with(['.', '-']) {
        return wrong("it begins with `.` or `-`");
    }
    if let Some(c) = name.chars().find(|&c| c == '/' || is_invisible(c)) {
        return wrong(&format!("it holds {c:?}"));
    }
    if name.len() > LONGEST {
        return wrong(&format!("it has {} bytes, more than {LONGEST}", name.len()));
    }
    Ok(())
}

/// Control characters, and others that change how text looks without being seen (Unicode's category Cf, as
/// far as it reorders text or has no width).
fn is_invisible(c: char) -> bool {
    let unseen = matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}');
    c.is_control() || unseen
}

/// The name of what the command line alone describes: environments, curricula, and every config field that is
/// set, by path, as in `MazeA_teach+her-iid_budget.steps=800`. The order in which they were typed does not
/// count. Where a name would be too long or hold something unfit, it says less and ends with a digest of
/// everything.
pub(super) fn of_options(environments: &[String], curricula: &[String], set: &Table) -> String {
    let sorted = |ids: &[String]| {
        let mut ids = ids.to_vec();
        ids.sort();
        ids.join("+")
    };
    let mut parts = vec![sorted(environments), sorted(curricula)];
    fields("", set, &mut parts);
    parts[2..].sort();
    let whole = parts.join("_");
    let fine = |c: char| c.is_alphanumeric() || "-_.=+, ".contains(c);
    if whole.len() <= LONGEST && whole.chars().all(fine) {
        return whole;
    }
    let kept: String = whole.chars().map(|c| if fine(c) { c } else { '-' }).collect();
    let end = kept.floor_char_boundary(LONGEST - DIGITS - 1);
    format!("{}_{}", &kept[..end], &digest::sha256(whole.as_bytes())[..DIGITS])
}

/// Appends `path=value` for every field of `table`, by path.
fn fields(prefix: &str, table: &Table, parts: &mut Vec<String>) {
    for (key, value) in table {
        let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value {
            Value::Table(below) => fields(&path, below, parts),
            Value::String(text) => parts.push(format!("{path}={text}")),
            other => parts.push(format!("{path}={other}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_any_script_are_kept_and_unfit_ones_refused() {
        for good in ["smoke", "日本語", "Прогон 3", "été, v1.2", "a'b"] {
            assert_eq!(check(good), Ok(()), "{good}");
        }
        for bad in [
            "",
            "  ",
            " a",
            "a ",
            ".",
            "..",
            ".hidden",
            "-x",
            "a/b",
            "a\nb",
            "a\0b",
            "a\u{202e}b",
            "\u{200b}",
        ] {
            let reason = check(bad).expect_err(bad);
            assert!(reason.contains("cannot be a name") && !reason.contains('\u{202e}'), "{reason}");
        }
        assert!(check(&"x".repeat(LONGEST + 1)).is_err());
    }

    #[test]
    fn commands_are_named_by_what_they_ask_for() {
        let ids = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let set = |text: &str| text.parse::<Table>().expect("TOML");
        let name = |text: &str| of_options(&ids(&["MazeA"]), &ids(&["teach", "her-iid"]), &set(text));
        assert_eq!(name(""), "MazeA_her-iid+teach");
        let text = "budget.steps = 800\nstudent.noise = { std = 0.1 }\nstudent.preset = 'official'";
        assert_eq!(
            name(text),
            "MazeA_her-iid+teach_budget.steps=800_student.noise.std=0.1_student.preset=official"
        );
        // Too long, or with what no folder's name can hold: told apart all the same.
        let long = |last: u32| {
            name(
                &(0..60)
                    .map(|n| format!("field{n} = {n}\n"))
                    .collect::<String>()
                    .replace("= 59", &format!("= {last}")),
            )
        };
        assert!(long(1).len() <= LONGEST && long(1) != long(2), "{}", long(1));
        assert_eq!(check(&long(1)), Ok(()));
        assert_ne!(name("student.agent = 'a/b'"), name("student.agent = 'a-b'"));
        assert!(!name("student.agent = 'a/b'").contains('/'));
    }
}
