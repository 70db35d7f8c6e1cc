#include "services/localizer/paper/particle_kernels.hpp"

namespace luminav {

#if defined(LUMINAV_HAS_AVX2_KERNELS)
const ParticleKernels& avx2_particle_kernels();
#endif

const ParticleKernels& particle_kernels() {
#if defined(LUMINAV_HAS_AVX2_KERNELS)
  static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
  return has_avx2 ? avx2_particle_kernels() : portable_particle_kernels();
#else
  return portable_particle_kernels();
#endif
}

}  // namespace luminav
