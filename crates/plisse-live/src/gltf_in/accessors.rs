//! Numbers of accessors, each checked against its buffer before it is read.

use gltf::accessor::sparse::IndexType;
use gltf::accessor::{Accessor, DataType};
use plisse::{Error, Result};

use crate::Vec3;

/// Largest number of values in one accessor; more would be a broken file.
const MOST: usize = 1 << 28;

/// The buffers of a file, to be read by its accessors.
pub(super) struct Accessors<'a> {
    /// The name of the file in errors.
    pub(super) place: &'a str,
    pub(super) buffers: Vec<Vec<u8>>,
}

/// A sentence about the file.
pub(super) fn bad<T>(place: &str, message: impl Into<String>) -> Result<T> {
    Err(Error::mesh(place, message))
}

impl Accessors<'_> {
    /// All vectors of `accessor`.
    pub(super) fn vectors(&self, accessor: &Accessor<'_>, what: &str) -> Result<Vec<Vec3>> {
        Ok(self.numbers(accessor, 3, what)?.chunks_exact(3).map(Vec3::from_column_slice).collect())
    }

    /// All numbers of `accessor`, whose elements must have `width` of them; normalised integers
    /// become fractions.
    pub(super) fn numbers(
        &self,
        accessor: &Accessor<'_>,
        width: usize,
        what: &str,
    ) -> Result<Vec<f32>> {
        if accessor.dimensions().multiplicity() != width {
            return bad(
                self.place,
                format!(
                    "{what}: there are {} numbers where {width} belong; export the file again",
                    accessor.dimensions().multiplicity()
                ),
            );
        }
        let scale = match accessor.data_type() {
            DataType::I8 => 127.0,
            DataType::U8 => 255.0,
            DataType::I16 => 32767.0,
            DataType::U16 => 65535.0,
            DataType::U32 | DataType::F32 => 1.0,
        };
        let scale = if accessor.normalized() { scale } else { 1.0 };
        let values: Vec<f32> =
            self.raw(accessor, what)?.iter().map(|&x| (x / scale) as f32).collect();
        match values.iter().position(|x| !x.is_finite()) {
            Some(i) => bad(
                self.place,
                format!("{what}: entry {} is no finite number; export the file again", i / width),
            ),
            None => Ok(values),
        }
    }

    /// All numbers of `accessor` as they are stored, with those of its sparse entries.
    pub(super) fn raw(&self, accessor: &Accessor<'_>, what: &str) -> Result<Vec<f64>> {
        let (width, count) = (accessor.dimensions().multiplicity(), accessor.count());
        let (data_type, size) = (accessor.data_type(), accessor.size());
        if count.checked_mul(width).is_none_or(|n| n > MOST) {
            return bad(
                self.place,
                format!("{what}: {count} entries are too many; split the file"),
            );
        }
        let mut values = match accessor.view() {
            Some(view) => {
                let stride = view.stride().unwrap_or(size);
                self.stored(&view, accessor.offset(), stride, [count, width], data_type, what)?
            }
            None => vec![0.0; count * width],
        };
        if accessor.sparse().is_some() {
            self.put_sparse(accessor, &mut values, what)?;
        }
        Ok(values)
    }

    /// Puts the entries of a sparse accessor into `values`, the numbers under it.
    fn put_sparse(&self, accessor: &Accessor<'_>, values: &mut [f64], what: &str) -> Result<()> {
        let Some(sparse) = accessor.sparse().filter(|s| s.count() > 0) else { return Ok(()) };
        let (width, count) = (accessor.dimensions().multiplicity(), accessor.count());
        let (data_type, size) = (accessor.data_type(), accessor.size());
        let (indices, others) = (sparse.indices(), sparse.values());
        let index_type = match indices.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        if sparse.count() > count {
            return bad(
                self.place,
                format!(
                    "{what}: {} sparse entries for {count} are too many; export the file again",
                    sparse.count()
                ),
            );
        }
        let shape = [sparse.count(), 1];
        let places = self.stored(
            &indices.view(),
            indices.offset(),
            bytes_of(index_type),
            shape,
            index_type,
            what,
        )?;
        let others = self.stored(
            &others.view(),
            others.offset(),
            size,
            [sparse.count(), width],
            data_type,
            what,
        )?;
        for (i, &place) in places.iter().enumerate() {
            let Some(target) = values.get_mut(place as usize * width..(place as usize + 1) * width)
            else {
                return bad(
                    self.place,
                    format!(
                        "{what}: a sparse entry names {place} of {count}; export the file again"
                    ),
                );
            };
            target.copy_from_slice(&others[i * width..(i + 1) * width]);
        }
        Ok(())
    }

    /// `[count][width]` numbers of `data_type` in `view` from `offset` (bytes) on, elements
    /// `stride` bytes apart.
    fn stored(
        &self,
        view: &gltf::buffer::View<'_>,
        offset: usize,
        stride: usize,
        [count, width]: [usize; 2],
        data_type: DataType,
        what: &str,
    ) -> Result<Vec<f64>> {
        let one = bytes_of(data_type);
        let size = one * width;
        let part = view
            .offset()
            .checked_add(view.length())
            .and_then(|end| self.buffers[view.buffer().index()].get(view.offset()..end));
        let needed = count.checked_sub(1).map_or(Some(0), |last| {
            last.checked_mul(stride)?.checked_add(size)?.checked_add(offset)
        });
        let (Some(part), Some(needed)) = (part, needed) else {
            return bad(
                self.place,
                format!("{what} lies outside its buffer; export the file again"),
            );
        };
        if needed > part.len() {
            return bad(
                self.place,
                format!(
                    "{what} needs {needed} bytes, but only {} are there; export the file again",
                    part.len()
                ),
            );
        }
        let mut values = Vec::with_capacity(count * width);
        for i in 0..count {
            for k in 0..width {
                let b = &part[offset + i * stride + k * one..][..one];
                values.push(match data_type {
                    DataType::I8 => f64::from(b[0] as i8),
                    DataType::U8 => f64::from(b[0]),
                    DataType::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
                    DataType::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
                    DataType::U32 => f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
                    DataType::F32 => f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
                });
            }
        }
        Ok(values)
    }
}

/// Bytes of one number.
fn bytes_of(data_type: DataType) -> usize {
    match data_type {
        DataType::I8 | DataType::U8 => 1,
        DataType::I16 | DataType::U16 => 2,
        DataType::U32 | DataType::F32 => 4,
    }
}
