//! A column says everything about itself: name, type and meaning for those who compute with it, and how it is
//! shown to those who read it.

use std::borrow::Cow;

use polars::prelude::{Column as Series, NamedFrom as _, Series as Values};

use super::markup::Align;

/// A column of a table whose rows are made of `R`s. It is in the data, in the table to read, or in both.
pub struct Column<'c, R> {
    data: Option<Data<'c, R>>,
    shown: Option<Shown<'c, R>>,
}

/// What those who compute with the table get.
struct Data<'c, R> {
    name: Cow<'static, str>,
    meaning: Cow<'static, str>,
    values: Kind<'c, R>,
}

/// The value of a column for each row, by its type; `None` where there is none.
enum Kind<'c, R> {
    Text(Value<'c, R, String>),
    Count(Value<'c, R, u64>),
    Real(Value<'c, R, f64>),
    /// Columns that stand in the data under names of their own.
    Several,
}

type Value<'c, R, T> = Box<dyn Fn(&R) -> Option<T> + 'c>;

/// What those who read the table get.
struct Shown<'c, R> {
    title: &'static str,
    align: Align,
    text: Box<dyn Fn(&R) -> String + 'c>,
}

/// What the data dictionary says of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnInfo {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Its type.
    pub kind: &'static str,
    /// Its meaning, with unit.
    pub meaning: Cow<'static, str>,
}

impl<'c, R> Column<'c, R> {
    /// A column of text.
    pub fn text<T: Into<Option<String>>>(
        name: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&R) -> T + 'c,
    ) -> Self {
        Self::of(name, meaning, Kind::Text(Box::new(move |row| value(row).into())))
    }

    /// A column of whole numbers.
    pub fn count<T: Into<Option<u64>>>(
        name: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&R) -> T + 'c,
    ) -> Self {
        Self::of(name, meaning, Kind::Count(Box::new(move |row| value(row).into())))
    }

    /// A column of real numbers.
    pub fn real<T: Into<Option<f64>>>(
        name: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        value: impl Fn(&R) -> T + 'c,
    ) -> Self {
        Self::of(name, meaning, Kind::Real(Box::new(move |row| value(row).into())))
    }

    /// An entry of the data dictionary for columns of real numbers that are known from the results alone:
    /// those without a meaning of their own.
    pub fn several(name: &'static str, meaning: &'static str) -> Self {
        Self::of(name, meaning, Kind::Several)
    }

    fn of(
        name: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        values: Kind<'c, R>,
    ) -> Self {
        Self { data: Some(Data { name: name.into(), meaning: meaning.into(), values }), shown: None }
    }

    /// A column to read that is not in the data, of numbers.
    pub fn only_shown(title: &'static str, text: impl Fn(&R) -> String + 'c) -> Self {
        Self { data: None, shown: None }.shown(title, text)
    }

    /// A column to read that is not in the data, of names or prose.
    pub fn only_named(title: &'static str, text: impl Fn(&R) -> String + 'c) -> Self {
        Self { data: None, shown: None }.named(title, text)
    }

    /// Shows the column below `title`, as a number.
    #[must_use]
    pub fn shown(self, title: &'static str, text: impl Fn(&R) -> String + 'c) -> Self {
        Self { shown: Some(Shown { title, align: Align::Number, text: Box::new(text) }), ..self }
    }

    /// Shows the column below `title`, as a name or prose.
    #[must_use]
    pub fn named(self, title: &'static str, text: impl Fn(&R) -> String + 'c) -> Self {
        Self { shown: Some(Shown { title, align: Align::Text, text: Box::new(text) }), ..self }
    }

    /// Title and alignment, where the column is shown.
    pub(super) fn header(&self) -> Option<(&'static str, Align)> {
        self.shown.as_ref().map(|shown| (shown.title, shown.align))
    }

    /// What is shown for a row, where the column is shown.
    pub(super) fn cell(&self, row: &R) -> Option<String> {
        self.shown.as_ref().map(|shown| (shown.text)(row))
    }

    /// What the data dictionary says of it; nothing of a column without a meaning of its own.
    pub(super) fn info(&self) -> Option<ColumnInfo> {
        let Data { name, meaning, values } = self.data.as_ref().filter(|data| !data.meaning.is_empty())?;
        let kind = match values {
            Kind::Text(_) => "string",
            Kind::Count(_) => "u64",
            Kind::Real(_) | Kind::Several => "f64",
        };
        Some(ColumnInfo { name: name.clone(), kind, meaning: meaning.clone() })
    }

    /// The values of `rows`, where the column is in the data.
    pub(super) fn series(&self, rows: &[&R]) -> Option<Series> {
        let Data { name, values, .. } = self.data.as_ref()?;
        let name = name.as_ref().into();
        let values = match values {
            Kind::Text(value) => Values::new(name, rows.iter().map(|row| value(row)).collect::<Vec<_>>()),
            Kind::Count(value) => Values::new(name, rows.iter().map(|row| value(row)).collect::<Vec<_>>()),
            Kind::Real(value) => Values::new(name, rows.iter().map(|row| value(row)).collect::<Vec<_>>()),
            Kind::Several => return None,
        };
        Some(values.into())
    }
}
