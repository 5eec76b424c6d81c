#include "converter/memory/page_buffer.h"

#include <sys/mman.h>

#include <new>

namespace strata {

PageBuffer::PageBuffer(std::size_t bytes) : bytes_(bytes), data_(nullptr) {
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  (void)::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish
  data_ = static_cast<std::byte*>(memory);
}

PageBuffer::~PageBuffer() { ::munmap(data_, bytes_); }

}  // namespace strata
