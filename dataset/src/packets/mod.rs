//! A Velodyne HDL-64E's data packets: [`Firings`] as a capture file that other tools open, and captures as [`Firings`].
//!
//! A data packet is a UDP datagram to port 2368 of 1206 bytes, numbers little endian: 12 blocks, then a time stamp of 4
//! bytes (microseconds of the hour) and 2 bytes of status. A block is a header (`0xEEFF` for the upper bank's lasers,
//! 0 to 31 in the unit's numbering, `0xDDFF` for the lower bank's, 32 to 63), the encoder's angle in hundredths of a
//! degree, and for each of 32 lasers a range in units of 2 mm (0: no return) and an intensity. (Velodyne Acoustics,
//! HDL-64E S2 user's manual; `rawdata.h` of ros-drivers/velodyne.) An upper and a lower block of one angle are a
//! firing, six of them a packet.
//!
//! [`write()`] makes a capture in the classic pcap format, little endian, of Ethernet frames stamped to the nanosecond.
//! [`read`] takes either order of bytes and micro- or nanoseconds, passes over and counts what is no data packet, and
//! refuses what is broken, naming the packet by its number in the file, from 1.
//!
//! **Times.** A packet has one stamp, here the time of its first firing, and its other firings are spread evenly over the
//! time to the next packet. Firings of an even clock come back to 2 ns, any others to 100 ns: where the clock is uneven,
//! packets are filled up with blocks that hold no return. A filler is a pair of upper blocks.
//!
//! **Intensities** are all 0 in a capture of firings that have none, and a capture whose intensities are all 0 has none.

mod datagram;
mod error;
mod order;
mod payload;
mod pcap;
mod read;
mod times;
mod write;

pub use error::{PacketError, Unfit, WrongPacket};
pub use order::Order;
pub use read::{Start, Tally, read};
pub use write::{check, write};

#[cfg(doc)]
use crate::Firings;
