// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "gl.h"

#include <array>
#include <string>

#include "palpate/core/error.h"

namespace palpate::view {
namespace {

GLuint compile(GLenum type, const char* source) {
  const GLuint shader = glCreateShader(type);
  const std::array<const char*, 2> parts{"#version 330 core\n", source};
  glShaderSource(shader, 2, parts.data(), nullptr);
  glCompileShader(shader);
  return shader;
}

}  // namespace

ShaderProgram::ShaderProgram(const char* vertex, const char* fragment)
    : program_(glCreateProgram()) {
  for (const GLuint shader :
       {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(program_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program_);
  GLint linked = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked != 0) return;
  std::string words(1024, '\0');
  GLsizei length = 0;
  glGetProgramInfoLog(program_, static_cast<GLsizei>(words.size()), &length, words.data());
  words.resize(static_cast<std::size_t>(length));
  glDeleteProgram(program_);
  throw Error("OpenGL: a shader is refused by the driver: " + words);
}

ShaderProgram::~ShaderProgram() { glDeleteProgram(program_); }

void ShaderProgram::set(const char* name, float value) const { glUniform1f(place(name), value); }
void ShaderProgram::set(const char* name, const Eigen::Vector3f& value) const {
  glUniform3fv(place(name), 1, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Vector4f& value) const {
  glUniform4fv(place(name), 1, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Matrix3f& value) const {
  glUniformMatrix3fv(place(name), 1, GL_FALSE, value.data());
}
void ShaderProgram::set(const char* name, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(place(name), 1, GL_FALSE, value.data());
}

VertexArray::~VertexArray() {
  for (const GLuint buffer : buffers_) glDeleteBuffers(1, &buffer);
  glDeleteBuffers(1, &indices_);
  glDeleteVertexArrays(1, &array_);
}

GLuint VertexArray::buffer_of(GLuint index) {
  if (buffers_.size() <= index) buffers_.resize(index + 1, 0);
  if (buffers_[index] == 0) glGenBuffers(1, &buffers_[index]);
  return buffers_[index];
}

void VertexArray::put_floats(GLuint index, int size, const void* data, std::size_t bytes) {
  bind();
  glBindBuffer(GL_ARRAY_BUFFER, buffer_of(index));
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_DYNAMIC_DRAW);
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void VertexArray::put_colors(GLuint index, const void* data, std::size_t bytes) {
  bind();
  glBindBuffer(GL_ARRAY_BUFFER, buffer_of(index));
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_DYNAMIC_DRAW);
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0, nullptr);
}

void VertexArray::replace(GLuint index, const void* data, std::size_t begin, std::size_t bytes) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer_of(index));
  glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(begin), static_cast<GLsizeiptr>(bytes),
                  data);
}

void VertexArray::put_indices(const void* data, std::size_t bytes) {
  bind();
  if (indices_ == 0) glGenBuffers(1, &indices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
}

void Texture::put(const void* rgba, int width, int height) {
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

}  // namespace palpate::view
