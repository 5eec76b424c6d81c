#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "core/error.h"
#include "render/gl/gl_context.h"

namespace strata::test {

enum class ContextKind { egl, osMesa };

inline std::string contextName(ContextKind kind) { return kind == ContextKind::egl ? "Egl" : "OsMesa"; }

/// Makes llvmpipe say that it has 64-bit atomic minima in storage blocks. It compiles and runs them, but version 22.3
/// does not list the extension. Call this before the process makes its first context. Other drivers are left alone.
void offerWideAtomicsInSoftware();

/// Makes a context. Null, with the reason, where the machine cannot.
inline std::unique_ptr<GlContext> tryContext(ContextKind kind, std::string& reason) {
  try {
    return kind == ContextKind::egl ? createEglContext() : createOsMesaContext();
  } catch (const Error& error) {
    reason = error.what();
    return nullptr;
  }
}

}  // namespace strata::test

/// Makes `context` of `kind`, or skips the test with the reason.
#define STRATA_REQUIRE_CONTEXT(context, kind)                                                   \
  std::string context##Reason;                                                                  \
  std::unique_ptr<strata::GlContext> context = strata::test::tryContext(kind, context##Reason); \
  if (context == nullptr) GTEST_SKIP() << context##Reason
