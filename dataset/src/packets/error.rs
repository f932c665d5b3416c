//! What can be wrong with a capture, and in which packet.

use crate::firings::Misfit;

/// A capture that is not what it must be: which packet, and what is wrong.
#[derive(Debug, thiserror::Error)]
#[error("{}{wrong}", if *packet == 0 { String::new() } else { format!("packet {packet}: ") })]
pub struct PacketError {
    /// The packet's number in the file, from 1, those counted that are passed over; 0 for the file's own header.
    pub packet: u64,
    /// The rule and the value.
    pub wrong: WrongPacket,
}

/// What is wrong with a packet, or with the file's header.
#[derive(Debug, thiserror::Error)]
pub enum WrongPacket {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Unreadable(#[source] std::io::Error),
    /// No capture in the classic format.
    #[error("must be a pcap file (magic a1b2c3d4 or a1b23c4d), not one that begins with {found:08x}")]
    Magic {
        /// The first four bytes.
        found: u32,
    },
    /// The newer format of captures.
    #[error("must be a classic pcap file, not pcapng (editcap -F pcap converts it)")]
    PcapNg,
    /// A version that nobody writes.
    #[error("the pcap format must be of version 2, not {found}")]
    Version {
        /// Major version.
        found: u16,
    },
    /// Frames of another kind than Ethernet.
    #[error("frames must be Ethernet's (link type 1), not of link type {found}")]
    Link {
        /// The link type.
        found: u32,
    },
    /// The file ends within a header or a packet.
    #[error("the file seems to have been cut short: {expected} bytes must follow, not {found}")]
    CutShort {
        /// Bytes that must follow.
        expected: usize,
        /// Bytes that do.
        found: usize,
    },
    /// Longer than any frame.
    #[error("must not be longer than {limit_bytes} bytes, as {found} would be")]
    TooLong {
        /// The limit.
        limit_bytes: u32,
        /// Its length.
        found: u32,
    },
    /// Only the beginning of a data packet was captured.
    #[error("must have been captured whole: {found} of {expected} bytes are there")]
    Snapped {
        /// Its bytes on the wire.
        expected: u32,
        /// Its bytes in the file.
        found: u32,
    },
    /// A share of a second of one or more.
    #[error("the stamp's fraction must be less than a second, not {found} parts of {parts}")]
    Fraction {
        /// The fraction.
        found: u32,
        /// Parts of a second.
        parts: u32,
    },
    /// Stamped earlier than the data packet before it.
    #[error("times must not decrease: {t_s} s follows {previous_s} s")]
    TimeGoesBack {
        /// Its stamp.
        t_s: f64,
        /// The stamp of the one before.
        previous_s: f64,
    },
    /// Bytes that changed on their way.
    #[error("the UDP checksum must be {expected:#06x}, not {found:#06x}")]
    Checksum {
        /// What it must be.
        expected: u16,
        /// What stands there.
        found: u16,
    },
    /// A block of neither bank, or of the wrong one.
    #[error("block {block} must begin with {expected:#06x}, not {found:#06x}")]
    Header {
        /// Which of the 12 blocks, from 0.
        block: usize,
        /// The bank's mark.
        expected: u16,
        /// What stands there.
        found: u16,
    },
    /// An upper block with returns, and no lower block to it.
    #[error("block {block} must be followed by a lower block, for it has returns")]
    Unpaired {
        /// Which of the 12 blocks, from 0.
        block: usize,
    },
    /// An angle beyond a full turn.
    #[error("block {block}: the encoder's angle must be less than 36000 hundredths of a degree, not {found}")]
    Encoder {
        /// Which of the 12 blocks, from 0.
        block: usize,
        /// Its angle.
        found: u16,
    },
    /// Two angles in one firing.
    #[error("block {block} must have the angle of the block before it, {expected}, not {found}")]
    TwoAngles {
        /// Which of the 12 blocks, from 0.
        block: usize,
        /// The upper block's angle.
        expected: u16,
        /// The lower block's angle.
        found: u16,
    },
    /// More firings than any honest drive.
    #[error("there must not be more than {limit} firings")]
    TooMany {
        /// The limit.
        limit: usize,
    },
}

/// Firings that an HDL-64E's packets cannot hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// Columns that do not fit together.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// Another unit's firings.
    #[error("an HDL-64E has 64 lasers, not {found}")]
    Lasers {
        /// How many there are.
        found: usize,
    },
    /// A time that a capture has no stamp for.
    #[error("firing {firing}: its time must lie from 0 to 4294967295 s, unlike {t_s}")]
    Time {
        /// Which firing, from 0.
        firing: usize,
        /// Its time.
        t_s: f64,
    },
    /// More than the reader takes.
    #[error("there must not be more than {limit} firings, as {found} are")]
    TooMany {
        /// The limit.
        limit: usize,
        /// How many there are.
        found: usize,
    },
}
