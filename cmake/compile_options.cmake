# Our own warnings and sanitizers; nothing here reaches users of the library.
add_library(raymap_compile_options INTERFACE)
target_compile_options(raymap_compile_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wno-missing-field-initializers)
# GCC 12 sees overlapping copies in std::string's operator+ where there are none (GCC bug 105651).
target_compile_options(raymap_compile_options INTERFACE
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  # As on x86-64, only what asks for it is fused.
  add_compile_options(-ffp-contract=off)
  # Structs have members of Highway's vectors. Those of SVE have no size that a compiler knows.
  add_compile_definitions(HWY_BROKEN_TARGETS=HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)
endif()
if(RAYMAP_WERROR)
  target_compile_options(raymap_compile_options INTERFACE -Werror)
endif()
if(CMAKE_UNITY_BUILD)
  # One file's names may shadow another's, and GCC takes an included file for a header.
  target_compile_options(raymap_compile_options INTERFACE -Wno-shadow
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>)
endif()
if(RAYMAP_SANITIZE)
  # One instruction set is enough to find what sanitizers find; six take minutes to compile with them. x86-64 by itself
  # has no SIMD for Highway; not -march=native, whose objects a compiler cache would give to another machine.
  add_compile_definitions(HWY_COMPILE_ONLY_STATIC)
  include(CheckCXXSourceRuns)
  check_cxx_source_runs("int main() {
    return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") && __builtin_cpu_supports(\"aes\") ? 0 : 1;
  }" RAYMAP_HAS_AVX2)
  if(RAYMAP_HAS_AVX2)
    # As in any other build, only what asks for it is fused.
    add_compile_options(-march=x86-64-v3 -maes -mpclmul -ffp-contract=off)
  endif()
  # GCC has macros for these, clang has not.
  if(RAYMAP_SANITIZE MATCHES thread)
    add_compile_definitions(RAYMAP_THREAD_SANITIZER)
  endif()
  if(RAYMAP_SANITIZE MATCHES address)
    add_compile_definitions(RAYMAP_ADDRESS_SANITIZER)
  endif()
  add_compile_options(-fsanitize=${RAYMAP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${RAYMAP_SANITIZE})
  # GCC's own manual warns of false alarms where sanitizers change the flow of the code.
  target_compile_options(raymap_compile_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()
