//! Apache Thrift's compact protocol, in which Parquet files describe themselves: enough of it to look at sizes before
//! anything of such a size is allocated.

/// Structs and lists within one another; Parquet's take six.
const DEEPEST: usize = 16;

/// Types of values, as they are encoded.
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I32: u8 = 5;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const MAP: u8 = 11;
const STRUCT: u8 = 12;
const UUID: u8 = 13;

/// A number or the length of a list, where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Item {
    Number(i64),
    Length(usize),
}

/// Reads bytes from the first on.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Bytes read so far.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    /// Passes over bytes; `None` where there are not as many.
    pub(super) fn pass(&mut self, count: usize) -> Option<()> {
        self.at = self.at.checked_add(count).filter(|&at| at <= self.bytes.len())?;
        Some(())
    }

    /// Reads a struct and calls `each` with every number and list in it and the numbers of the fields on the way there;
    /// `None` where the bytes are none.
    pub(super) fn read_struct(&mut self, each: &mut impl FnMut(&[i16], Item)) -> Option<()> {
        self.fields(&mut Vec::new(), each)
    }

    fn fields(&mut self, path: &mut Vec<i16>, each: &mut impl FnMut(&[i16], Item)) -> Option<()> {
        if path.len() >= DEEPEST {
            return None;
        }
        let mut field: i16 = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            field = match head >> 4 {
                0 => i16::try_from(self.signed()?).ok()?,
                step => field.checked_add(i16::from(step))?,
            };
            path.push(field);
            // A truth value is its type.
            if !matches!(head & 15, TRUE | FALSE) {
                self.value(head & 15, path, each)?;
            }
            path.pop();
        }
    }

    fn value(
        &mut self,
        kind: u8,
        path: &mut Vec<i16>,
        each: &mut impl FnMut(&[i16], Item),
    ) -> Option<()> {
        match kind {
            TRUE | FALSE | BYTE => self.pass(1),
            I16 | I32 | I64 => {
                each(path, Item::Number(self.signed()?));
                Some(())
            }
            DOUBLE => self.pass(8),
            UUID => self.pass(16),
            BINARY => {
                let length = usize::try_from(self.unsigned()?).ok()?;
                self.pass(length)
            }
            LIST | SET => {
                let head = self.byte()?;
                let length = match head >> 4 {
                    15 => usize::try_from(self.unsigned()?).ok()?,
                    short => usize::from(short),
                };
                each(path, Item::Length(length));
                (0..length).try_for_each(|_| self.element(head & 15, path, each))
            }
            MAP => {
                let length = self.unsigned()?;
                let kinds = if length > 0 { self.byte()? } else { 0 };
                (0..length).try_for_each(|_| {
                    self.element(kinds >> 4, path, each)?;
                    self.element(kinds & 15, path, each)
                })
            }
            STRUCT => self.fields(path, each),
            _ => None,
        }
    }

    /// Lists within lists count as deep as structs.
    fn element(
        &mut self,
        kind: u8,
        path: &mut Vec<i16>,
        each: &mut impl FnMut(&[i16], Item),
    ) -> Option<()> {
        if !matches!(kind, LIST | SET | MAP) {
            return self.value(kind, path, each);
        }
        if path.len() >= DEEPEST {
            return None;
        }
        path.push(0);
        self.value(kind, path, each)?;
        path.pop();
        Some(())
    }

    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn unsigned(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 127) << shift;
            if byte & 128 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// Zigzag: 0, −1, 1, −2, …
    fn signed(&mut self) -> Option<i64> {
        let value = self.unsigned()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Option<Vec<(Vec<i16>, Item)>> {
        let mut found = Vec::new();
        let mut reader = Reader::new(bytes);
        reader.read_struct(&mut |path, item| found.push((path.to_vec(), item)))?;
        assert_eq!(reader.position(), bytes.len());
        Some(found)
    }

    #[test]
    fn numbers_and_lengths_are_found_where_they_stand() {
        // 1: i32 −3, 2: true, 4: list of 2 structs { 1: i32 1 } and { 3: "ab" }, 20: i64 300.
        let bytes = [
            0x15, 0x05, 0x11, 0x29, 0x2c, 0x15, 0x02, 0x00, 0x38, 0x02, b'a', b'b', 0x00, 0x06,
            0x28, 0xd8, 0x04, 0x00,
        ];
        let expected = [
            (vec![1], Item::Number(-3)),
            (vec![4], Item::Length(2)),
            (vec![4, 1], Item::Number(1)),
            (vec![20], Item::Number(300)),
        ];
        assert_eq!(read(&bytes).unwrap(), expected);
    }

    #[test]
    fn lengths_beyond_the_end_and_depths_without_end_are_refused() {
        // A text of 2⁶² bytes, a list of 2³¹ numbers, structs without end.
        assert_eq!(read(&[&[0x18][..], &[0xff; 8], &[0x3f, 0x00]].concat()), None);
        assert_eq!(read(&[0x19, 0xf5, 0xff, 0xff, 0xff, 0xff, 0x07, 0x00]), None);
        assert_eq!(read(&[0x1c; 1000]), None);
        assert_eq!(read(&[&[0x19][..], &[0x19; 1000]].concat()), None);
        assert_eq!(read(&[]), None);
    }
}
