#pragma once
#include <gmock/gmock.h>

#include "pipeline/model/error.h"

/// Expects `statement` to throw an Error of `exit_code` whose message contains `text`.
#define EXPECT_ERROR(statement, exit_code, text)                        \
  try {                                                                 \
    statement;                                                          \
    ADD_FAILURE() << "no error from " #statement;                       \
  } catch (const patchlight::Error& error) {                            \
    EXPECT_EQ(int(error.code()), int(exit_code)) << error.what();       \
    EXPECT_THAT(std::string(error.what()), ::testing::HasSubstr(text)); \
  }
