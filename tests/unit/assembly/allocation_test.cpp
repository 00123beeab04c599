// No call of the assembler allocates: counted by replacing operator new of the test program.
#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include <gtest/gtest.h>

#include "assembly/assembler.hpp"
#include "tests/bodies.hpp"

#if !defined(__SANITIZE_ADDRESS__)  // which replaces operator new itself

namespace {

std::atomic<long> allocations{0};

void* allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, rounded ? rounded : alignment);
  if (!memory) throw std::bad_alloc();
  return memory;
}

[[gnu::noinline]] void release(void* memory) { std::free(memory); }

}  // namespace

// The forms for arrays and without exceptions call these.
void* operator new(std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, std::size_t(alignment));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace peristat {
namespace {

TEST(Assembler, AllocatesNothingInItsCalls) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const tests::BoxBody body(tests::small_box(dimension));
    Assembler assembler(body.points, body.model, 2);
    const std::vector<double> state = body.random_state(1);
    std::vector<double> gradient(body.dofs()), product(body.dofs()),
        v = state, energies(body.points.volume.size());
    Tangent tangent(BlockPattern(body.model.bonds()), dimension);
    bool degenerate = assembler.energy(state).degenerate;  // the threads start here
    assembler.tangent(state, tangent);  // the first one makes its rows and wider sums

    const long before = allocations;
    degenerate |= assembler.energy(state).degenerate;
    degenerate |= assembler.gradient(state, gradient).degenerate;
    assembler.tangent(state, tangent);
    assembler.product(state, v, product);
    (void)assembler.point_energies(state, energies);
    EXPECT_EQ(allocations, before) << dimension << "D";
    EXPECT_FALSE(degenerate);
  }
  EXPECT_GT(allocations, 0);
}

}  // namespace
}  // namespace peristat

#endif
