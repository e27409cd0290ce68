// Views as nvcc's device code and the host compiler lay them out: check.py compares what this program prints
// with the addresses in the PTX of the kernels below. No kernel runs, so no GPU is needed.

#include <Kokkos_Core.hpp>
#include <cstdio>

namespace {

using Space = Kokkos::CudaSpace;

/// Members after the first one show the size of those before them.
struct Several {
  Kokkos::View<double* [3], Space> a;
  Kokkos::View<int*, Space> b;
  Kokkos::View<double**, Kokkos::LayoutRight, Space> c;
};

alignas(16) unsigned long words[64];  // each holds its own place [bytes]

unsigned long place_of(const void* data) { return reinterpret_cast<unsigned long>(data); }

}  // namespace

__global__ void view_layout(Several views, unsigned long* out) {
  out[0] = views.a.extent(0);
  out[1] = views.b.extent(0);
  out[2] = views.c.extent(1);
  out[3] = reinterpret_cast<unsigned long>(views.c.data());
}

int main() {
  for (unsigned long n = 0; n < 64; ++n) words[n] = n * sizeof(long);
  const Several& views =
      *reinterpret_cast<const Several*>(words);  // whose members then hold their own places
  std::printf("%zu: %zu %zu %zu %lu\n", sizeof views, std::size_t(views.a.extent(0)),
              std::size_t(views.b.extent(0)), std::size_t(views.c.extent(1)), place_of(views.c.data()));
}
