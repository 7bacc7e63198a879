use super::encodings::{encoding, masked_form};
use super::*;
use iced_x86::Encoder;

const STACK: u32 = 1 << 19;

fn encoded(instructions: &[Instruction]) -> Vec<u8> {
    let (mut encoder, mut end) = (Encoder::new(64), ORIGIN);
    for instruction in instructions {
        end += encoder.encode(instruction, end).expect("encodes") as u64;
    }
    encoder.take_buffer()
}

/// A function with a frame of `bytes`, which stores a vector at `offset` and executes `other`.
fn function(bytes: i64, offset: i64, other: Instruction) -> Vec<u8> {
    let place = MemoryOperand::with_base_displ(Register::RSP, offset);
    encoded(&[
        change(Code::Sub_rm64_imm32, bytes).expect("fits"),
        Instruction::with2(Code::Movdqu_xmmm128_xmm, place, Register::XMM3).expect("valid"),
        other,
        change(Code::Add_rm64_imm32, bytes).expect("fits"),
        Instruction::with(Code::Retnq),
    ])
}

fn sum(code: Code, [to, a, b]: [Register; 3]) -> Instruction {
    Instruction::with3(code, to, a, b).expect("valid")
}

fn narrow_sum() -> Instruction {
    let registers = [Register::XMM1, Register::XMM2, Register::XMM15];
    sum(Code::VEX_Vaddps_xmm_xmm_xmmm128, registers)
}

#[test]
fn instructions_and_what_is_on_the_stack_become_wider() {
    for (width, first, size, stored, added) in [
        (
            Width::Ymm,
            Register::YMM0,
            448,
            Code::VEX_Vmovups_ymmm256_ymm,
            Code::VEX_Vaddps_ymm_ymm_ymmm256,
        ),
        (
            Width::Zmm,
            Register::ZMM0,
            832,
            Code::EVEX_Vmovups_zmmm512_k1z_zmm,
            Code::EVEX_Vaddps_zmm_k1z_zmm_zmmm512b32_er,
        ),
    ] {
        // The 64 bytes of slots stay in place. Vectors behind them move, or are kept in a register
        // if the width has more registers than Cranelift uses.
        for (offset, behind) in [(0, 0), (48, 0), (64, 0), (80, 1), (240, 11)] {
            let narrow = function(256, offset, narrow_sum());
            let code = widened(&narrow, width, 64, STACK).expect("known");
            let found = instructions(&code).expect("a function");
            let [make, store, add, give_up, zero, end] = found[..] else { panic!("{found:?}") };
            assert_eq!((make.immediate(1), give_up.immediate(1)), (size, size));
            assert_eq!((store.code(), store.op1_register()), (stored, first + 3));
            if offset >= 64 && width == Width::Zmm {
                assert_eq!(store.op0_register(), Register::ZMM16);
            } else {
                let moved = if behind == 0 { offset } else { 64 + behind * width.bytes() as i64 };
                assert_eq!(store.memory_displacement64() as i64, moved);
            }
            assert_eq!(add, sum(added, [first + 1, first + 2, first + 15]));
            assert_eq!([zero.code(), end.code()], [Code::VEX_Vzeroupper, Code::Retnq]);
        }
    }
}

#[test]
fn comparisons_of_512_bits_are_vectors_of_them_again() {
    use Register::*;
    let registers = [XMM1, XMM2, XMM3];
    let compare = Code::VEX_Vcmppd_xmm_xmm_xmmm128_imm8;
    let compare = Instruction::with4(compare, XMM1, XMM2, XMM3, 2).expect("valid");
    let choose = Code::VEX_Vblendvps_xmm_xmm_xmmm128_xmm;
    let choose = Instruction::with4(choose, XMM1, XMM2, XMM3, XMM4).expect("valid");
    let signs = Instruction::with2(Code::VEX_Vmovmskps_r32_xmm, EAX, XMM5).expect("valid");
    let equal = sum(Code::VEX_Vpcmpeqd_xmm_xmm_xmmm128, registers);
    let with2 = |code, to, a| Instruction::with2(code, to, a).expect("valid");
    let compared = Code::EVEX_Vcmppd_kr_k1_zmm_zmmm512b64_imm8_sae;
    let compared = Instruction::with4(compared, K1, ZMM2, ZMM3, 2).expect("valid");
    let mut chosen = sum(Code::EVEX_Vblendmps_zmm_k1z_zmm_zmmm512b32, [ZMM1, ZMM2, ZMM3]);
    chosen.set_op_mask(K1);
    let equals = sum(Code::EVEX_Vpcmpeqd_kr_k1_zmm_zmmm512b32, [K1, ZMM2, ZMM3]);
    for (narrow, expected) in [
        (compare, [compared, with2(Code::EVEX_Vpmovm2q_zmm_kr, ZMM1, K1)]),
        (choose, [with2(Code::EVEX_Vpmovd2m_kr_zmm, K1, ZMM4), chosen]),
        (
            signs,
            [with2(Code::EVEX_Vpmovd2m_kr_zmm, K1, ZMM5), with2(Code::VEX_Kmovw_r32_kr, EAX, K1)],
        ),
        (equal, [equals, with2(Code::EVEX_Vpmovm2d_zmm_kr, ZMM1, K1)]),
    ] {
        let code = widened(&function(16, 0, narrow), Width::Zmm, 0, STACK).expect("known");
        let found = instructions(&code).expect("a function");
        assert_eq!(found[2..4], expected);
        assert_eq!(found[3].op_mask(), expected[1].op_mask());
    }
}

#[test]
fn instructions_are_the_same_but_for_moves_and_logic() {
    use Mnemonic::*;
    let moves = [Movapd, Movaps, Movdqa, Movdqu, Movdqu, Vmovdqa, Vmovdqu, Vmovdqu];
    let logic = [Vpand, Vpor, Vpxor];
    for (width, others) in [(Width::Ymm, &[][..]), (Width::Zmm, &[Vroundpd, Vroundps])] {
        let mut differing = Vec::new();
        for code in Code::values() {
            if let Some(wide) = encoding(code, width)
                && wide.mnemonic() != code.mnemonic()
            {
                differing.push(code.mnemonic());
            }
        }
        differing.sort_by_key(|mnemonic| format!("{mnemonic:?}"));
        assert_eq!(differing, [&moves[..], &logic, others].concat());
    }
}

#[test]
fn each_instruction_is_known_of_all_widths() {
    for code in Code::values() {
        let is_known = encoding(code, Width::Zmm).is_some() || masked_form(code).is_some();
        assert_eq!(encoding(code, Width::Ymm).is_some(), is_known, "{code:?}");
    }
}

#[test]
fn branches_lead_to_what_takes_an_instruction_s_place() {
    let branch = |code, to| Instruction::with_branch(code, to).expect("valid");
    let mut all = vec![
        change(Code::Sub_rm64_imm32, 64).expect("fits"),
        branch(Code::Jb_rel32_64, ORIGIN),
        narrow_sum(),
        change(Code::Add_rm64_imm32, 64).expect("fits"),
        Instruction::with(Code::Retnq),
    ];
    // The branch skips the sum and leads to the instruction that frees the stack.
    let end = ORIGIN + encoded(&all[..3]).len() as u64;
    all[1] = branch(Code::Jb_rel32_64, end);
    let found = instructions(&widened(&encoded(&all), Width::Ymm, 0, STACK).expect("known"));
    let found = found.expect("a function");
    assert_eq!(found[1].near_branch_target(), found[3].ip());
    assert_eq!((found[3].code(), found[3].immediate(1)), (Code::Add_rm64_imm32, 128));
    // A branch into the middle of an instruction is refused.
    all[1] = branch(Code::Jb_rel32_64, end + 2);
    assert_eq!(widened(&encoded(&all), Width::Ymm, 0, STACK), None);
    // Branches with one byte for their distance are refused, since a target may be too far in
    // longer code.
    all[1] = branch(Code::Jb_rel8_64, end - 4);
    assert_eq!(widened(&encoded(&all), Width::Ymm, 0, STACK), None);
}

#[test]
fn each_page_of_a_large_frame_is_touched() {
    let code =
        widened(&function(7 * PAGE / 2, 0, narrow_sum()), Width::Ymm, 0, STACK).expect("known");
    let found = instructions(&code).expect("a function");
    let touched = found.iter().filter(|one| one.code() == Code::Mov_rm32_imm32).count();
    let is_made = |one: &&Instruction| one.code() == Code::Sub_rm64_imm32;
    let made: u64 = found.iter().filter(is_made).map(|one| one.immediate(1)).sum();
    assert_eq!((touched, made), (7, 7 * PAGE as u64));
}

#[test]
fn what_is_not_known_stays_as_it_is() {
    let registers = [Register::XMM1, Register::XMM2, Register::XMM3];
    let shuffle = sum(Code::VEX_Vpshufb_xmm_xmm_xmmm128, registers);
    let below = MemoryOperand::with_base_displ(Register::RSP, -8);
    let below = Instruction::with2(Code::Mov_r64_rm64, Register::RAX, below).expect("valid");
    let call = Instruction::with_branch(Code::Call_rel32_64, ORIGIN).expect("valid");
    let through = Instruction::with1(Code::Call_rm64, Register::RAX).expect("valid");
    let code = Code::VEX_Vpshufd_xmm_xmmm128_imm8;
    let halves = Instruction::with3(code, Register::XMM1, Register::XMM2, 0b01_00_01_00_u32);
    let halves = halves.expect("valid");
    for width in Width::ALL {
        for other in [shuffle, below, call, through, halves] {
            assert_eq!(widened(&function(256, 64, other), width, 0, STACK), None, "{other:?}");
        }
        assert_eq!(widened(&function(256, 64, narrow_sum()), width, 48, STACK), None);
        let most = i64::from(STACK) / width.times() as i64;
        assert_eq!(widened(&function(most + 16, 0, narrow_sum()), width, 0, STACK), None);
        assert!(widened(&function(most, 0, narrow_sum()), width, 0, STACK).is_some());
        // Code without a return instruction is refused.
        assert_eq!(widened(&encoded(&[narrow_sum()]), width, 0, STACK), None);
    }
}
