//! Finds vertices at equal positions.

use super::Position;

/// Average probes for each vertex after which the table gives up: positions chosen to collide, which no real mesh has.
const PROBE_LIMIT: usize = 16;

/// An empty slot.
const EMPTY: u32 = u32::MAX;

/// For each vertex the first vertex with the same position (-0 is 0). Linear; the table takes 6 to 12 bytes a vertex.
///
/// The result does not depend on the hash.
pub(super) fn merge<P: Position>(positions: &[P]) -> Vec<u32> {
    by_table(positions).unwrap_or_else(|| by_sorting(positions))
}

/// Bits of a position; equal positions have equal bits.
#[inline]
fn bits<P: Position>(position: P) -> [u32; 3] {
    let [x, y, z] = position.coordinates();
    [(x + 0.0).to_bits(), (y + 0.0).to_bits(), (z + 0.0).to_bits()]
}

/// Folds 96 bits into 64 that depend on all of them.
#[inline]
fn hash([x, y, z]: [u32; 3]) -> u64 {
    let low = u64::from(x) << 32 | u64::from(y);
    let mixed = (low ^ 0x9e37_79b9_7f4a_7c15).wrapping_mul(0xd6e8_feb8_6659_fd93) ^ u64::from(z);
    let mixed = (mixed ^ mixed >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
    mixed ^ mixed >> 32
}

#[expect(clippy::cast_possible_truncation, reason = "the mask leaves less than a usize")]
fn by_table<P: Position>(positions: &[P]) -> Option<Vec<u32>> {
    let capacity = (positions.len() + positions.len() / 2 + 1).next_power_of_two();
    let mask = capacity as u64 - 1;
    let mut table = vec![EMPTY; capacity];
    let mut same = Vec::with_capacity(positions.len());
    let mut probes_left = PROBE_LIMIT * positions.len() + 1024;
    for (vertex, &position) in (0_u32..).zip(positions) {
        let bits_here = bits(position);
        let mut slot = (hash(bits_here) & mask) as usize;
        loop {
            let first = table[slot];
            if first == EMPTY {
                table[slot] = vertex;
                same.push(vertex);
                break;
            }
            if bits(positions[first as usize]) == bits_here {
                same.push(first);
                break;
            }
            probes_left = probes_left.checked_sub(1)?;
            slot = (slot + 1) & mask as usize;
        }
    }
    Some(same)
}

fn by_sorting<P: Position>(positions: &[P]) -> Vec<u32> {
    let mut order: Vec<u32> = (0_u32..).zip(positions).map(|(vertex, _)| vertex).collect();
    let key = |&vertex: &u32| (bits(positions[vertex as usize]), vertex);
    order.sort_unstable_by_key(key);
    let mut same = vec![0; positions.len()];
    for equal in order.chunk_by(|a, b| key(a).0 == key(b).0) {
        for &vertex in equal {
            same[vertex as usize] = equal[0];
        }
    }
    same
}

#[cfg(test)]
mod tests {
    use super::{bits, by_sorting, by_table, hash, merge};

    #[test]
    fn table_and_sorting_agree() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            [0.0, -0.0, 1.0, f32::MIN_POSITIVE, -7.5][(state >> 16) as usize % 5]
        };
        let positions: Vec<[f32; 3]> = (0..3000).map(|_| [random(), random(), random()]).collect();
        let table = by_table(&positions).expect("no collisions to speak of");
        assert_eq!(table, by_sorting(&positions));
        for (vertex, &first) in table.iter().enumerate() {
            assert!(first as usize <= vertex && positions[first as usize] == positions[vertex]);
            assert_eq!(table[first as usize], first);
        }
        assert_eq!(table.iter().enumerate().filter(|&(vertex, &first)| vertex == first as usize).count(), 64);
    }

    /// Positions that all fall into one slot of their table: the table gives up, the result is right.
    #[test]
    fn chosen_collisions_do_not_hang() {
        let slot = |position| hash(bits(position)) % 4096;
        let collide = |vertex: u32| {
            let x = f32::from_bits(vertex);
            (0..).map(|z| [x, 0.0, f32::from_bits(z)]).find(|&position| slot(position) == 7)
        };
        let positions: Vec<[f32; 3]> = (0..2000).filter_map(collide).collect();
        assert_eq!(by_table(&positions), None);
        assert!(merge(&positions).iter().zip(0..).all(|(&first, vertex)| first == vertex));
    }
}
