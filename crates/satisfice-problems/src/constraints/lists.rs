//! Lists one after another in one piece of memory.

/// Lists of numbers: memory is read in order, and a list costs four bytes beside its numbers.
#[derive(Debug, Clone)]
pub(super) struct Lists<T> {
    items: Vec<T>,
    /// Where each list ends.
    ends: Vec<u32>,
}

impl<T: Copy> Lists<T> {
    /// These lists, or `None` if they have 2^32 numbers or more in all.
    pub(super) fn new<'a>(lists: impl ExactSizeIterator<Item = &'a [T]>) -> Option<Self>
    where
        T: 'a,
    {
        let (mut items, mut ends) = (Vec::new(), Vec::with_capacity(lists.len()));
        for list in lists {
            items.extend_from_slice(list);
            ends.push(u32::try_from(items.len()).ok()?);
        }
        Some(Self { items, ends })
    }

    /// Number of lists.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// List `index`.
    ///
    /// # Panics
    /// If there is no such list.
    pub(super) fn get(&self, index: usize) -> &[T] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.items[start as usize..self.ends[index] as usize]
    }

    /// All lists, in order.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[T]> {
        let mut rest = &self.items[..];
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let (list, after) = rest.split_at((end - start) as usize);
            (rest, start) = (after, end);
            list
        })
    }
}

impl Lists<u32> {
    /// For each key below `keys` the positions at which it stands in `of`, ascending; `None` there stands nowhere.
    pub(super) fn positions(keys: usize, of: impl Iterator<Item = Option<usize>> + Clone) -> Self {
        let mut starts = vec![0; keys + 1];
        for key in of.clone().flatten() {
            starts[key + 1] += 1;
        }
        for key in 0..keys {
            starts[key + 1] += starts[key];
        }
        let mut items = vec![0; starts[keys] as usize];
        for (position, key) in (0..).zip(of) {
            if let Some(key) = key {
                items[starts[key] as usize] = position;
                starts[key] += 1;
            }
        }
        starts.truncate(keys); // filling has moved each start to the end
        Self { items, ends: starts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_come_back_as_they_were() {
        let lists = [&[1, 2][..], &[], &[3], &[]];
        let kept = Lists::new(lists.into_iter()).unwrap();
        assert_eq!(kept.len(), 4);
        assert_eq!(kept.iter().collect::<Vec<_>>(), lists);
        assert!((0..4).all(|index| kept.get(index) == lists[index]));
        assert_eq!(Lists::<u8>::new([].into_iter()).unwrap().iter().count(), 0);
    }

    #[test]
    fn positions_are_those_of_each_key() {
        let keys = [Some(2), None, Some(0), Some(2), Some(2)];
        let positions = Lists::positions(4, keys.into_iter());
        assert_eq!(
            positions.iter().collect::<Vec<_>>(),
            [&[2][..], &[], &[0, 3, 4], &[]]
        );
    }
}
