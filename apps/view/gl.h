// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GL/glew.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace palpate::view {

/// A program of OpenGL 3.3.
class ShaderProgram {
 public:
  /// \param vertex, fragment sources without the line of the version.
  /// \throws Error with the driver's words if they do not compile.
  ShaderProgram(const char* vertex, const char* fragment);
  ~ShaderProgram();
  ShaderProgram(const ShaderProgram&) = delete;
  ShaderProgram& operator=(const ShaderProgram&) = delete;

  void use() const { glUseProgram(program_); }
  // Of the program in use.
  void set(const char* name, float value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Vector4f& value) const;
  void set(const char* name, const Eigen::Matrix3f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  [[nodiscard]] GLint place(const char* name) const { return glGetUniformLocation(program_, name); }
  GLuint program_;
};

/// Attributes of vertices, each in a buffer of its own, and indices.
class VertexArray {
 public:
  VertexArray() { glGenVertexArrays(1, &array_); }
  ~VertexArray();
  VertexArray(const VertexArray&) = delete;
  VertexArray& operator=(const VertexArray&) = delete;

  void bind() const { glBindVertexArray(array_); }
  /// Attribute `index`: `size` floats a vertex.
  void put_floats(GLuint index, int size, const void* data, std::size_t bytes);
  /// Attribute `index`: 4 bytes a vertex, 0 to 255 for 0 to 1.
  void put_colors(GLuint index, const void* data, std::size_t bytes);
  /// Replaces a part of the data of an attribute. \param begin, bytes in its buffer
  void replace(GLuint index, const void* data, std::size_t begin, std::size_t bytes);
  void put_indices(const void* data, std::size_t bytes);

 private:
  GLuint buffer_of(GLuint index);
  GLuint array_ = 0;
  std::vector<GLuint> buffers_;  // by attribute; 0: none
  GLuint indices_ = 0;
};

/// A picture in memory of which shaders read, without smoothing.
class Texture {
 public:
  Texture() { glGenTextures(1, &texture_); }
  ~Texture() { glDeleteTextures(1, &texture_); }
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  /// \param rgba rows from the top, 4 bytes a pixel
  void put(const void* rgba, int width, int height);
  [[nodiscard]] GLuint name() const { return texture_; }

 private:
  GLuint texture_ = 0;
};

}  // namespace palpate::view
