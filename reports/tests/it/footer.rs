//! The footer of a Parquet file, read without polars: which encodings its columns are in.
//!
//! Source: the Parquet format's `parquet.thrift`, and Thrift's compact protocol.

use std::collections::BTreeMap;

/// A value of Thrift's compact protocol, as far as footers hold any.
enum Value {
    Number(i64),
    Other,
    List(Vec<Value>),
    Struct(BTreeMap<i16, Value>),
}

impl Value {
    fn field(&self, id: i16) -> &Self {
        match self {
            Self::Struct(fields) => &fields[&id],
            _ => panic!("no struct"),
        }
    }

    fn items(&self) -> &[Self] {
        match self {
            Self::List(items) => items,
            _ => panic!("no list"),
        }
    }

    fn number(&self) -> i64 {
        match self {
            Self::Number(number) => *number,
            _ => panic!("no number"),
        }
    }
}

/// The encodings of every column of every row group, as the format numbers them. Shape: one list per column.
pub(crate) fn encodings(file: &[u8]) -> Vec<Vec<i64>> {
    let (body, magic) = file.split_at(file.len() - 4);
    assert_eq!(magic, b"PAR1");
    let (body, length) = body.split_at(body.len() - 4);
    let length = u32::from_le_bytes(length.try_into().unwrap()) as usize;
    let mut reader = Reader(&body[body.len() - length..]);
    // FileMetaData.row_groups, RowGroup.columns, ColumnChunk.meta_data, ColumnMetaData.encodings.
    let footer = reader.structure();
    let columns = footer.field(4).items().iter().flat_map(|group| group.field(1).items());
    let of_column = |column: &Value| column.field(3).field(2).items().iter().map(Value::number).collect();
    columns.map(of_column).collect()
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().unwrap();
        self.0 = rest;
        *first
    }

    fn varint(&mut self) -> u64 {
        let (mut value, mut shift) = (0, 0);
        loop {
            let byte = self.byte();
            value |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte & 0x80 == 0 {
                return value;
            }
        }
    }

    fn zigzag(&mut self) -> i64 {
        let value = self.varint();
        (value >> 1) as i64 ^ -((value & 1) as i64)
    }

    fn skip(&mut self, count: usize) -> Value {
        self.0 = &self.0[count..];
        Value::Other
    }

    fn structure(&mut self) -> Value {
        let (mut fields, mut id) = (BTreeMap::new(), 0);
        loop {
            let head = self.byte();
            if head == 0 {
                return Value::Struct(fields);
            }
            id = if head >> 4 == 0 { self.zigzag() as i16 } else { id + i16::from(head >> 4) };
            let value = match head & 0xf {
                // The value of a flag is its type.
                1 | 2 => Value::Other,
                kind => self.value(kind),
            };
            fields.insert(id, value);
        }
    }

    fn value(&mut self, kind: u8) -> Value {
        match kind {
            1..=3 => self.skip(1),
            4..=6 => Value::Number(self.zigzag()),
            7 => self.skip(8),
            8 => {
                let length = self.varint() as usize;
                self.skip(length)
            }
            9 | 10 => {
                let head = self.byte();
                let count = if head >> 4 == 15 { self.varint() } else { u64::from(head >> 4) };
                Value::List((0..count).map(|_| self.value(head & 0xf)).collect())
            }
            12 => self.structure(),
            other => panic!("unknown type {other}"),
        }
    }
}
