//! Loops over double-double numbers, compiled a second time for processors with fused multiply-add, where it is one
//! instruction; elsewhere it is a function call. The results are the same on both.

/// Defines a function whose body is compiled for both.
macro_rules! fused {
    ($(#[$meta:meta])* $visibility:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        $visibility fn $name($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn plain($($argument: $type),*) $(-> $result)? $body

            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma")]
                fn with_instruction($($argument: $type),*) $(-> $result)? {
                    plain($($argument),*)
                }
                if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                    // SAFETY: the processor has these instructions.
                    return unsafe { with_instruction($($argument),*) };
                }
            }
            plain($($argument),*)
        }
    };
}

pub(crate) use fused;
