//! Instructions for vectors of 128 bits, and their equivalents for wider ones.

use super::{Width, is_vector};
use iced_x86::{Code, Instruction, OpKind, Register};

/// Immediate of the shuffle that copies the upper half of a vector to both halves.
const UPPER: u8 = 0b11_10_11_10;

/// Mask register that passes a bit per lane from one instruction to the next.
const LANES: Register = Register::K1;

/// Writes an instruction's equivalent for wider vectors. Returns `None` if none is known.
pub(super) fn widen(
    instruction: &Instruction,
    width: Width,
    written: &mut Vec<Instruction>,
) -> Option<()> {
    if width == Width::Zmm
        && let Some(masked_form) = masked_form(instruction.code())
    {
        return widen_with_mask(instruction, &masked_form, written);
    }
    let [to, a, b] = [0, 1, 2].map(|operand| instruction.op_register(operand));
    let whole = |register| width.whole(register);
    match instruction.code() {
        // Moves the upper half of a vector to the lower half of another.
        Code::VEX_Vpshufd_xmm_xmmm128_imm8 if is_vector(a) && instruction.immediate8() == UPPER => {
            let code = match width {
                Width::Zmm => Code::EVEX_Vextractf64x4_ymmm256_k1z_zmm_imm8,
                Width::Ymm => Code::VEX_Vextractf128_xmmm128_ymm_imm8,
            };
            written.push(Instruction::with3(code, width.half(to), whole(a), 1).ok()?);
        }
        // Joins the lower halves of two vectors.
        Code::VEX_Vpunpcklqdq_xmm_xmm_xmmm128 if is_vector(b) => {
            let code = match width {
                Width::Zmm => Code::EVEX_Vinsertf64x4_zmm_k1z_zmm_ymmm256_imm8,
                Width::Ymm => Code::VEX_Vinsertf128_ymm_ymm_xmmm128_imm8,
            };
            let half = width.half(b);
            written.push(Instruction::with4(code, whole(to), whole(a), half, 1).ok()?);
        }
        code => {
            let mut wider = *instruction;
            wider.set_code(encoding(code, width)?);
            // These two instructions convert between lanes of different sizes, so one of their
            // operands is half a vector.
            let [is_read, is_written] =
                [Code::VEX_Vcvtps2pd_xmm_xmmm64, Code::VEX_Vcvtpd2ps_xmm_xmmm128]
                    .map(|other| other == code);
            for operand in 0..wider.op_count() {
                let is_half = if operand == 0 { is_written } else { is_read };
                if wider.op_kind(operand) == OpKind::Register {
                    let register = wider.op_register(operand);
                    let wide = if is_half { width.half(register) } else { whole(register) };
                    wider.set_op_register(operand, wide);
                }
            }
            written.push(wider);
        }
    }
    Some(())
}

/// Writes the equivalent of an instruction that uses a mask register.
fn widen_with_mask(
    instruction: &Instruction,
    masked_form: &MaskedForm,
    written: &mut Vec<Instruction>,
) -> Option<()> {
    let whole = |operand| Width::Zmm.whole(instruction.op_register(operand));
    let mut other = *instruction;
    other.set_code(masked_form.code());
    for operand in 0..other.op_count() {
        if other.op_kind(operand) == OpKind::Register {
            other.set_op_register(operand, whole(operand));
        }
    }
    match *masked_form {
        MaskedForm::Compare(_, spread) => {
            other.set_op0_register(LANES);
            written.push(other);
            written.push(Instruction::with2(spread, whole(0), LANES).ok()?);
        }
        MaskedForm::Choose(_, gather) => {
            written.push(Instruction::with2(gather, LANES, whole(3)).ok()?);
            other.set_op_mask(LANES);
            written.push(other);
        }
        MaskedForm::Signs(gather) => {
            let to = instruction.op0_register();
            written.push(Instruction::with2(gather, LANES, whole(1)).ok()?);
            written.push(Instruction::with2(Code::VEX_Kmovw_r32_kr, to, LANES).ok()?);
        }
    }
    Some(())
}

/// An instruction for 512 bits that uses a bit per lane, where its narrower form uses a vector.
pub(super) enum MaskedForm {
    /// A comparison, and the instruction that expands its bits to a vector.
    Compare(Code, Code),
    /// A choice, and the instruction that gathers its bits from a vector.
    Choose(Code, Code),
    /// The instruction that gathers the signs of a vector in a mask register. They are then copied
    /// to a general register.
    Signs(Code),
}

impl MaskedForm {
    fn code(&self) -> Code {
        match *self {
            Self::Compare(code, _) | Self::Choose(code, _) | Self::Signs(code) => code,
        }
    }
}

pub(super) fn masked_form(code: Code) -> Option<MaskedForm> {
    use MaskedForm::{Choose, Compare, Signs};
    let [spread, spread_f64] = [Code::EVEX_Vpmovm2d_zmm_kr, Code::EVEX_Vpmovm2q_zmm_kr];
    let [gather, gather_f64] = [Code::EVEX_Vpmovd2m_kr_zmm, Code::EVEX_Vpmovq2m_kr_zmm];
    Some(match code {
        Code::VEX_Vcmpps_xmm_xmm_xmmm128_imm8 => {
            Compare(Code::EVEX_Vcmpps_kr_k1_zmm_zmmm512b32_imm8_sae, spread)
        }
        Code::VEX_Vcmppd_xmm_xmm_xmmm128_imm8 => {
            Compare(Code::EVEX_Vcmppd_kr_k1_zmm_zmmm512b64_imm8_sae, spread_f64)
        }
        Code::VEX_Vpcmpeqd_xmm_xmm_xmmm128 => {
            Compare(Code::EVEX_Vpcmpeqd_kr_k1_zmm_zmmm512b32, spread)
        }
        Code::VEX_Vpcmpeqq_xmm_xmm_xmmm128 => {
            Compare(Code::EVEX_Vpcmpeqq_kr_k1_zmm_zmmm512b64, spread_f64)
        }
        Code::VEX_Vblendvps_xmm_xmm_xmmm128_xmm => {
            Choose(Code::EVEX_Vblendmps_zmm_k1z_zmm_zmmm512b32, gather)
        }
        Code::VEX_Vblendvpd_xmm_xmm_xmmm128_xmm => {
            Choose(Code::EVEX_Vblendmpd_zmm_k1z_zmm_zmmm512b64, gather_f64)
        }
        Code::VEX_Vmovmskps_r32_xmm => Signs(gather),
        Code::VEX_Vmovmskpd_r32_xmm => Signs(gather_f64),
        _ => return None,
    })
}

/// Matches the encoding of an instruction for 128 bits, and returns its encoding for 256 or 512
/// bits.
macro_rules! encodings {
    ($code:ident, $width:ident: $($narrow:ident => $ymm:ident $(| $zmm:ident)?,)*) => {
        match ($code, $width) {
            $((Code::$narrow, Width::Ymm) => Some(Code::$ymm),
            $((Code::$narrow, Width::Zmm) => Some(Code::$zmm),)?)*
            _ => None,
        }
    };
}

/// The encoding of an instruction for wider vectors. Moves and logic may become other instructions
/// with the same effect. For instructions that have no such encoding for 512 bits, see
/// [`masked_form`].
#[rustfmt::skip]
pub(super) fn encoding(code: Code, width: Width) -> Option<Code> {
    encodings! { code, width:
        Movaps_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        Movapd_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        Movdqa_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        Movdqu_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        Movdqu_xmmm128_xmm => VEX_Vmovups_ymmm256_ymm | EVEX_Vmovups_zmmm512_k1z_zmm,
        VEX_Vmovdqa_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        VEX_Vmovdqu_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        VEX_Vmovdqu_xmmm128_xmm => VEX_Vmovups_ymmm256_ymm | EVEX_Vmovups_zmmm512_k1z_zmm,
        VEX_Vmovups_xmm_xmmm128 => VEX_Vmovups_ymm_ymmm256 | EVEX_Vmovups_zmm_k1z_zmmm512,
        VEX_Vmovups_xmmm128_xmm => VEX_Vmovups_ymmm256_ymm | EVEX_Vmovups_zmmm512_k1z_zmm,
        VEX_Vmovupd_xmm_xmmm128 => VEX_Vmovupd_ymm_ymmm256 | EVEX_Vmovupd_zmm_k1z_zmmm512,
        VEX_Vmovupd_xmmm128_xmm => VEX_Vmovupd_ymmm256_ymm | EVEX_Vmovupd_zmmm512_k1z_zmm,
        VEX_Vaddps_xmm_xmm_xmmm128 => VEX_Vaddps_ymm_ymm_ymmm256 | EVEX_Vaddps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vaddpd_xmm_xmm_xmmm128 => VEX_Vaddpd_ymm_ymm_ymmm256 | EVEX_Vaddpd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vsubps_xmm_xmm_xmmm128 => VEX_Vsubps_ymm_ymm_ymmm256 | EVEX_Vsubps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vsubpd_xmm_xmm_xmmm128 => VEX_Vsubpd_ymm_ymm_ymmm256 | EVEX_Vsubpd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vmulps_xmm_xmm_xmmm128 => VEX_Vmulps_ymm_ymm_ymmm256 | EVEX_Vmulps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vmulpd_xmm_xmm_xmmm128 => VEX_Vmulpd_ymm_ymm_ymmm256 | EVEX_Vmulpd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vdivps_xmm_xmm_xmmm128 => VEX_Vdivps_ymm_ymm_ymmm256 | EVEX_Vdivps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vdivpd_xmm_xmm_xmmm128 => VEX_Vdivpd_ymm_ymm_ymmm256 | EVEX_Vdivpd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vminps_xmm_xmm_xmmm128 => VEX_Vminps_ymm_ymm_ymmm256 | EVEX_Vminps_zmm_k1z_zmm_zmmm512b32_sae,
        VEX_Vminpd_xmm_xmm_xmmm128 => VEX_Vminpd_ymm_ymm_ymmm256 | EVEX_Vminpd_zmm_k1z_zmm_zmmm512b64_sae,
        VEX_Vmaxps_xmm_xmm_xmmm128 => VEX_Vmaxps_ymm_ymm_ymmm256 | EVEX_Vmaxps_zmm_k1z_zmm_zmmm512b32_sae,
        VEX_Vmaxpd_xmm_xmm_xmmm128 => VEX_Vmaxpd_ymm_ymm_ymmm256 | EVEX_Vmaxpd_zmm_k1z_zmm_zmmm512b64_sae,
        VEX_Vsqrtps_xmm_xmmm128 => VEX_Vsqrtps_ymm_ymmm256 | EVEX_Vsqrtps_zmm_k1z_zmmm512b32_er,
        VEX_Vsqrtpd_xmm_xmmm128 => VEX_Vsqrtpd_ymm_ymmm256 | EVEX_Vsqrtpd_zmm_k1z_zmmm512b64_er,
        VEX_Vroundps_xmm_xmmm128_imm8 => VEX_Vroundps_ymm_ymmm256_imm8 | EVEX_Vrndscaleps_zmm_k1z_zmmm512b32_imm8_sae,
        VEX_Vroundpd_xmm_xmmm128_imm8 => VEX_Vroundpd_ymm_ymmm256_imm8 | EVEX_Vrndscalepd_zmm_k1z_zmmm512b64_imm8_sae,
        VEX_Vfmadd213ps_xmm_xmm_xmmm128 => VEX_Vfmadd213ps_ymm_ymm_ymmm256 | EVEX_Vfmadd213ps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vfmadd213pd_xmm_xmm_xmmm128 => VEX_Vfmadd213pd_ymm_ymm_ymmm256 | EVEX_Vfmadd213pd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vfmadd132ps_xmm_xmm_xmmm128 => VEX_Vfmadd132ps_ymm_ymm_ymmm256 | EVEX_Vfmadd132ps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vfmadd132pd_xmm_xmm_xmmm128 => VEX_Vfmadd132pd_ymm_ymm_ymmm256 | EVEX_Vfmadd132pd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vfmsub213ps_xmm_xmm_xmmm128 => VEX_Vfmsub213ps_ymm_ymm_ymmm256 | EVEX_Vfmsub213ps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vfmsub213pd_xmm_xmm_xmmm128 => VEX_Vfmsub213pd_ymm_ymm_ymmm256 | EVEX_Vfmsub213pd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vfmsub132ps_xmm_xmm_xmmm128 => VEX_Vfmsub132ps_ymm_ymm_ymmm256 | EVEX_Vfmsub132ps_zmm_k1z_zmm_zmmm512b32_er,
        VEX_Vfmsub132pd_xmm_xmm_xmmm128 => VEX_Vfmsub132pd_ymm_ymm_ymmm256 | EVEX_Vfmsub132pd_zmm_k1z_zmm_zmmm512b64_er,
        VEX_Vandps_xmm_xmm_xmmm128 => VEX_Vandps_ymm_ymm_ymmm256 | EVEX_Vandps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vandpd_xmm_xmm_xmmm128 => VEX_Vandpd_ymm_ymm_ymmm256 | EVEX_Vandpd_zmm_k1z_zmm_zmmm512b64,
        VEX_Vandnps_xmm_xmm_xmmm128 => VEX_Vandnps_ymm_ymm_ymmm256 | EVEX_Vandnps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vandnpd_xmm_xmm_xmmm128 => VEX_Vandnpd_ymm_ymm_ymmm256 | EVEX_Vandnpd_zmm_k1z_zmm_zmmm512b64,
        VEX_Vorps_xmm_xmm_xmmm128 => VEX_Vorps_ymm_ymm_ymmm256 | EVEX_Vorps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vorpd_xmm_xmm_xmmm128 => VEX_Vorpd_ymm_ymm_ymmm256 | EVEX_Vorpd_zmm_k1z_zmm_zmmm512b64,
        VEX_Vxorps_xmm_xmm_xmmm128 => VEX_Vxorps_ymm_ymm_ymmm256 | EVEX_Vxorps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vxorpd_xmm_xmm_xmmm128 => VEX_Vxorpd_ymm_ymm_ymmm256 | EVEX_Vxorpd_zmm_k1z_zmm_zmmm512b64,
        VEX_Vpand_xmm_xmm_xmmm128 => VEX_Vandps_ymm_ymm_ymmm256 | EVEX_Vandps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vpor_xmm_xmm_xmmm128 => VEX_Vorps_ymm_ymm_ymmm256 | EVEX_Vorps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vpxor_xmm_xmm_xmmm128 => VEX_Vxorps_ymm_ymm_ymmm256 | EVEX_Vxorps_zmm_k1z_zmm_zmmm512b32,
        VEX_Vcmpps_xmm_xmm_xmmm128_imm8 => VEX_Vcmpps_ymm_ymm_ymmm256_imm8,
        VEX_Vcmppd_xmm_xmm_xmmm128_imm8 => VEX_Vcmppd_ymm_ymm_ymmm256_imm8,
        VEX_Vblendvps_xmm_xmm_xmmm128_xmm => VEX_Vblendvps_ymm_ymm_ymmm256_ymm,
        VEX_Vblendvpd_xmm_xmm_xmmm128_xmm => VEX_Vblendvpd_ymm_ymm_ymmm256_ymm,
        VEX_Vmovmskps_r32_xmm => VEX_Vmovmskps_r32_ymm,
        VEX_Vmovmskpd_r32_xmm => VEX_Vmovmskpd_r32_ymm,
        VEX_Vpaddd_xmm_xmm_xmmm128 => VEX_Vpaddd_ymm_ymm_ymmm256 | EVEX_Vpaddd_zmm_k1z_zmm_zmmm512b32,
        VEX_Vpaddq_xmm_xmm_xmmm128 => VEX_Vpaddq_ymm_ymm_ymmm256 | EVEX_Vpaddq_zmm_k1z_zmm_zmmm512b64,
        VEX_Vpsubd_xmm_xmm_xmmm128 => VEX_Vpsubd_ymm_ymm_ymmm256 | EVEX_Vpsubd_zmm_k1z_zmm_zmmm512b32,
        VEX_Vpsubq_xmm_xmm_xmmm128 => VEX_Vpsubq_ymm_ymm_ymmm256 | EVEX_Vpsubq_zmm_k1z_zmm_zmmm512b64,
        VEX_Vpslld_xmm_xmm_imm8 => VEX_Vpslld_ymm_ymm_imm8 | EVEX_Vpslld_zmm_k1z_zmmm512b32_imm8,
        VEX_Vpsllq_xmm_xmm_imm8 => VEX_Vpsllq_ymm_ymm_imm8 | EVEX_Vpsllq_zmm_k1z_zmmm512b64_imm8,
        VEX_Vpsrld_xmm_xmm_imm8 => VEX_Vpsrld_ymm_ymm_imm8 | EVEX_Vpsrld_zmm_k1z_zmmm512b32_imm8,
        VEX_Vpsrlq_xmm_xmm_imm8 => VEX_Vpsrlq_ymm_ymm_imm8 | EVEX_Vpsrlq_zmm_k1z_zmmm512b64_imm8,
        VEX_Vpcmpeqd_xmm_xmm_xmmm128 => VEX_Vpcmpeqd_ymm_ymm_ymmm256,
        VEX_Vpcmpeqq_xmm_xmm_xmmm128 => VEX_Vpcmpeqq_ymm_ymm_ymmm256,
        VEX_Vcvtps2pd_xmm_xmmm64 => VEX_Vcvtps2pd_ymm_xmmm128 | EVEX_Vcvtps2pd_zmm_k1z_ymmm256b32_sae,
        VEX_Vcvtpd2ps_xmm_xmmm128 => VEX_Vcvtpd2ps_xmm_ymmm256 | EVEX_Vcvtpd2ps_ymm_k1z_zmmm512b64_er,
    }
}
