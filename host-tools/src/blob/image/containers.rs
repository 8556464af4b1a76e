use object::Endianness;
use object::elf;
use object::write::elf::{FileHeader, ProgramHeader, SectionHeader, Writer};

use super::memory_x::MemoryRegion;

/// Intel HEX: data records of 16 bytes with extended linear addresses.
#[must_use]
pub fn intel_hex(bytes: &[u8], slot: &MemoryRegion) -> String {
    let mut records = Vec::new();
    let mut upper = None;
    let mut address = slot.origin;
    let mut rest = bytes;
    while !rest.is_empty() {
        // No record runs across a border of 64 KiB, where its offset would wrap.
        let room = 0x1_0000 - (address & 0xffff) as usize;
        let (value, behind) = rest.split_at(rest.len().min(16).min(room));
        if upper != Some(address >> 16) {
            upper = Some(address >> 16);
            records.push(ihex::Record::ExtendedLinearAddress((address >> 16) as u16));
        }
        let offset = address as u16;
        records.push(ihex::Record::Data { offset, value: value.to_vec() });
        address = address.wrapping_add(value.len() as u32);
        rest = behind;
    }
    records.push(ihex::Record::EndOfFile);
    ihex::create_object_file_representation(&records)
        .unwrap_or_else(|e| unreachable!("records of 16 bytes: {e}"))
}

/// An ELF executable of 32-bit Arm with one loadable segment and one section
/// and no code: what `gdb`'s `load`, `probe-rs download` and `objcopy` take.
#[must_use]
pub fn elf(bytes: &[u8], slot: &MemoryRegion) -> Vec<u8> {
    let name = format!(".{}", slot.name.to_lowercase());
    let mut out = Vec::new();
    let mut w = Writer::new(Endianness::Little, false, &mut out);
    let (size, align, address) = (bytes.len() as u64, 4, u64::from(slot.origin));
    w.reserve_file_header();
    w.reserve_program_headers(1);
    let offset = w.reserve(size, align);
    let section = w.add_section_name(name.as_bytes());
    w.reserve_section_index();
    w.reserve_shstrtab_section_index();
    let written = w.reserve_shstrtab().and_then(|()| {
        w.reserve_section_headers();
        w.write_file_header(&FileHeader {
            e_type: elf::ET_EXEC,
            e_machine: elf::EM_ARM,
            e_flags: elf::EF_ARM_EABI_VER5,
            ..FileHeader::default()
        })
    });
    written.unwrap_or_else(|e| unreachable!("a slot is smaller than 4 GiB: {e}"));
    w.write_align_program_headers();
    w.write_program_header(&ProgramHeader {
        p_type: elf::PT_LOAD,
        p_flags: elf::PF_R,
        p_offset: offset,
        p_vaddr: address,
        p_paddr: address,
        p_filesz: size,
        p_memsz: size,
        p_align: align,
    });
    w.write_align(align);
    w.write(bytes);
    w.write_shstrtab();
    w.write_null_section_header();
    w.write_section_header(&SectionHeader {
        sh_name: w.section_name_offset(Some(section)),
        sh_type: elf::SHT_PROGBITS,
        sh_flags: elf::SHF_ALLOC,
        sh_addr: address,
        sh_offset: offset,
        sh_size: size,
        sh_addralign: align,
        ..SectionHeader::default()
    });
    w.write_shstrtab_section_header();
    out
}
