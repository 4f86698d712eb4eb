//! Recorded GPU commands: an operation number and a payload each.
//!
//! Payloads are postcard (a specified byte format without type information, specification 1.0) of the structs below.
//! A shipped struct never changes; a new need is a new operation number. Both sides use [`Command`] with their own copy
//! of this module; what the host's copy does not know is [`DecodeError::UnknownOperation`], with the command's index.

use super::values::Handle;
use abi_stable::StableAbi;
use abi_stable::std_types::RVec;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

impl Serialize for Handle {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.0)
    }
}

impl<'de> Deserialize<'de> for Handle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        u64::deserialize(deserializer).map(Self)
    }
}

/// One entry of a [`CommandListRecord`].
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandRecord {
    pub operation: u32,
    /// Where the payload starts in [`CommandListRecord::payload`]; bytes.
    pub start: u32,
    pub length: u32,
}

/// Commands in order.
#[repr(C)]
#[derive(StableAbi, Clone, Debug, Default, PartialEq, Eq)]
pub struct CommandListRecord {
    pub commands: RVec<CommandRecord>,
    pub payload: RVec<u8>,
}

/// Why a recorded command cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The plugin is newer than the host, or wrong.
    #[error(
        "command {index}: operation {operation} is not known to this host; update the host, or avoid it"
    )]
    UnknownOperation { index: usize, operation: u32 },
    /// The payload does not fit the operation.
    #[error("command {index}: the payload of operation {operation} is damaged")]
    DamagedPayload { index: usize, operation: u32 },
}

/// Appends a payload.
fn encode(payload: &impl Serialize, out: &mut Vec<u8>) {
    // Nearly all are short. A slice is filled several times faster than a vector, which grows byte by byte.
    let mut short = [0; 96];
    if let Ok(bytes) = postcard::to_slice(payload, &mut short) {
        out.extend_from_slice(bytes);
    } else {
        *out = postcard::to_extend(payload, core::mem::take(out))
            .expect("plain structs always serialise into a growing vector");
    }
}

/// Declares the operations: number, struct, documentation.
macro_rules! operations {
    ($($(#[$meta:meta])* $number:literal $name:ident { $($(#[$fmeta:meta])* $field:ident: $type:ty),* $(,)? })*) => {
        $($(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub struct $name { $($(#[$fmeta])* pub $field: $type),* }

        impl From<$name> for Command {
            fn from(command: $name) -> Self {
                Self::$name(command)
            }
        })*

        /// A command in memory. This enumeration does not cross the border; [`CommandListRecord`] does.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Command { $($(#[$meta])* $name($name)),* }

        impl Command {
            /// The operation number.
            pub fn operation(&self) -> u32 {
                match self { $(Self::$name(_) => $number),* }
            }

            /// The operation's name, for messages.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$name(_) => stringify!($name)),* }
            }

            /// Appends the payload.
            fn encode_payload(&self, out: &mut Vec<u8>) {
                match self {
                    $(Self::$name(command) => encode(command, out)),*
                }
            }

            fn decode_payload(operation: u32, payload: &[u8]) -> Option<Result<Self, postcard::Error>> {
                match operation {
                    $($number => Some(postcard::from_bytes::<$name>(payload).map(Self::$name)),)*
                    _ => None,
                }
            }
        }
    };
}

/// One colour attachment of a render pass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColourAttachment {
    /// A texture (its whole view) or a texture view.
    pub target: Handle,
    /// Where the samples are resolved to, or none.
    pub resolve: Handle,
    /// The clear value; none loads what is there.
    pub clear: Option<[f64; 4]>,
    /// Whether the result is kept.
    pub store: bool,
}

/// The depth attachment of a render pass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DepthAttachment {
    /// A texture or a texture view.
    pub target: Handle,
    /// The clear value; none loads what is there.
    pub clear: Option<f32>,
    /// Whether the result is kept.
    pub store: bool,
    /// Tested against, but not written; the texture may be read by shaders meanwhile.
    pub read_only: bool,
}

operations! {
    /// Opens a render pass. Its label names it in the timings.
    1 BeginRenderPass { label: String, colours: Vec<Option<ColourAttachment>>, depth: Option<DepthAttachment> }
    /// Closes the render pass.
    2 EndRenderPass {}
    /// Opens a compute pass.
    3 BeginComputePass { label: String }
    /// Closes the compute pass.
    4 EndComputePass {}
    /// Sets the render or compute pipeline of the open pass.
    5 SetPipeline { pipeline: Handle }
    /// Sets a bind group, with one offset for each dynamic binding.
    6 SetBindGroup { index: u32, group: Handle, offsets: Vec<u32> }
    /// Sets a vertex buffer.
    7 SetVertexBuffer { slot: u32, buffer: Handle, offset: u64 }
    /// Sets the index buffer: u32 if `wide`, else u16.
    8 SetIndexBuffer { buffer: Handle, offset: u64, wide: bool }
    /// Sets immediate data (push constants).
    9 SetImmediates { offset: u32, data: Vec<u8> }
    /// Sets the viewport; px and depth range.
    10 SetViewport { origin: [f32; 2], size: [f32; 2], depth: [f32; 2] }
    /// Sets the scissor rectangle; px.
    11 SetScissor { origin: [u32; 2], size: [u32; 2] }
    /// Sets the blend constant.
    12 SetBlendConstant { colour: [f64; 4] }
    /// Draws.
    13 Draw { vertex_count: u32, instance_count: u32, first_vertex: u32, first_instance: u32 }
    /// Draws by indices.
    14 DrawIndexed { index_count: u32, instance_count: u32, first_index: u32, base_vertex: i32, first_instance: u32 }
    /// Draws with arguments from a buffer.
    15 DrawIndirect { buffer: Handle, offset: u64 }
    /// Draws by indices with arguments from a buffer.
    16 DrawIndexedIndirect { buffer: Handle, offset: u64 }
    /// Runs compute workgroups.
    17 Dispatch { groups: [u32; 3] }
    /// Runs compute workgroups with arguments from a buffer.
    18 DispatchIndirect { buffer: Handle, offset: u64 }
    /// Copies between buffers; bytes, multiples of 4.
    19 CopyBufferToBuffer { source: Handle, source_offset: u64, target: Handle, target_offset: u64, size: u64 }
    /// Copies from a buffer to a texture; `bytes_per_row` a multiple of 256.
    20 CopyBufferToTexture { source: Handle, offset: u64, bytes_per_row: u32, target: Handle, mip_level: u32, origin: [u32; 3], size: [u32; 3] }
    /// Copies from a texture to a buffer; `bytes_per_row` a multiple of 256.
    21 CopyTextureToBuffer { source: Handle, mip_level: u32, origin: [u32; 3], size: [u32; 3], target: Handle, offset: u64, bytes_per_row: u32 }
    /// Copies between textures.
    22 CopyTextureToTexture { source: Handle, source_mip: u32, source_origin: [u32; 3], target: Handle, target_mip: u32, target_origin: [u32; 3], size: [u32; 3] }
    /// Fills a buffer with zeros; bytes, multiples of 4; size 0 is all that remain.
    23 ClearBuffer { buffer: Handle, offset: u64, size: u64 }
    /// Copies a buffer's bytes to the CPU; the ticket is polled in a later call.
    24 ReadBack { buffer: Handle, offset: u64, size: u64, ticket: Handle }
    /// Names the commands up to the matching pop, for graphics debuggers.
    25 PushDebugGroup { label: String }
    /// Ends the innermost debug group.
    26 PopDebugGroup {}
}

impl CommandListRecord {
    /// Appends a command.
    pub fn push(&mut self, command: impl Into<Command>) {
        let command = command.into();
        let start = self.payload.len() as u32;
        // RVec to Vec and back takes the allocation along; nothing is copied.
        let mut payload = core::mem::take(&mut self.payload).into_vec();
        command.encode_payload(&mut payload);
        self.payload = payload.into();
        let length = self.payload.len() as u32 - start;
        self.commands.push(CommandRecord {
            operation: command.operation(),
            start,
            length,
        });
    }

    /// The commands in order, each decoded when it is reached.
    pub fn decode(&self) -> impl Iterator<Item = Result<Command, DecodeError>> + '_ {
        self.commands.iter().enumerate().map(|(index, record)| {
            let CommandRecord {
                operation,
                start,
                length,
            } = *record;
            let damaged = DecodeError::DamagedPayload { index, operation };
            let end = start.checked_add(length).ok_or(damaged.clone())?;
            let payload = self
                .payload
                .get(start as usize..end as usize)
                .ok_or(damaged.clone())?;
            match Command::decode_payload(operation, payload) {
                Some(command) => command.map_err(|_| damaged),
                None => Err(DecodeError::UnknownOperation { index, operation }),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recorded_commands_come_back_in_order() {
        let mut list = CommandListRecord::default();
        let commands: Vec<Command> = vec![
            BeginComputePass {
                label: "cull".into(),
            }
            .into(),
            SetPipeline {
                pipeline: Handle(7 << 32 | 1),
            }
            .into(),
            Dispatch { groups: [1, 2, 3] }.into(),
            EndComputePass {}.into(),
            PushDebugGroup {
                label: "longer than what is encoded on the stack ".repeat(20),
            }
            .into(),
            PopDebugGroup {}.into(),
        ];
        commands
            .iter()
            .for_each(|command| list.push(command.clone()));
        let decoded: Result<Vec<_>, _> = list.decode().collect();
        assert_eq!(decoded.unwrap(), commands);
    }

    #[test]
    fn an_unknown_operation_is_named_with_its_index() {
        let mut list = CommandListRecord::default();
        list.push(EndComputePass {});
        list.commands.push(CommandRecord {
            operation: 999,
            start: 0,
            length: 0,
        });
        let error = list.decode().find_map(Result::err);
        assert_eq!(
            error,
            Some(DecodeError::UnknownOperation {
                index: 1,
                operation: 999
            })
        );
    }

    #[test]
    fn a_payload_outside_the_list_is_an_error() {
        let mut list = CommandListRecord::default();
        list.commands.push(CommandRecord {
            operation: 17,
            start: u32::MAX,
            length: 5,
        });
        list.commands.push(CommandRecord {
            operation: 17,
            start: 0,
            length: 5,
        });
        assert!(
            list.decode()
                .all(|command| matches!(command, Err(DecodeError::DamagedPayload { .. })))
        );
    }
}
