# SPDX-License-Identifier: Apache-2.0
# The files of musl's mathematical functions, without their suffix.
set(MEBOTS_MATH_FUNCTIONS
  acos acosh asin asinh atan atan2 atanh cbrt cos cosh erf exp exp10 exp2 expm1 hypot lgamma log log10 log1p log2
  pow sin sincos sinh tan tanh tgamma)
set(functions_of_float ${MEBOTS_MATH_FUNCTIONS})
list(TRANSFORM functions_of_float APPEND f)
list(APPEND MEBOTS_MATH_FUNCTIONS ${functions_of_float})

# Internal functions that the mathematical functions call.
set(MEBOTS_MATH_HELPERS
  __cos __cosdf __expo2 __expo2f __math_divzero __math_divzerof __math_invalid __math_invalidf __math_oflow __math_oflowf
  __math_uflow __math_uflowf __math_xflow __math_xflowf __rem_pio2 __rem_pio2_large __rem_pio2f __sin __sindf __tan __tandf
  exp2f_data exp_data lgamma_r lgammaf_r log2_data log2f_data log_data logf_data pow_data powf_data signgam)
