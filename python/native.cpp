// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The extension opencv_refract._native: what OpenCV's generator wrote for refract.hpp, with the conversions of OpenCV's
// own cv2 (cv2_convert, cv2_numpy, cv2_util), in a module of its own. It stands in the place of OpenCV's cv2.cpp.

#define PY_ARRAY_UNIQUE_SYMBOL opencv_ARRAY_API     // before NumPy's headers, shared with cv2_convert.cpp, cv2_numpy.cpp

#include "cv2.hpp"
#include "pyopencv_generated_include.h"
#include "cv2_util.hpp"
#include "cv2_numpy.hpp"
#include "cv2_convert.hpp"

// The types say where they live: opencv_refract.GlassWindow.
#undef MODULESTR
#define MODULESTR "opencv_refract"

using namespace cv;

// Arrays of the other byte order, and views into packed records, are copied first: the conversion of cv2 reads the former
// as if they were native and refuses the latter. Every conversion of the generated code to Mat comes here.
static bool pyopencv_to(PyObject* o, Mat& m, const ArgInfo& info)
{
    if (!o || !PyArray_Check(o) || PyArray_ISBEHAVED_RO((PyArrayObject*)o) || info.outputarg)
        return pyopencv_to<Mat>(o, m, info);
    PySafeObject copy(PyArray_FROM_OF(o, NPY_ARRAY_ALIGNED | NPY_ARRAY_NOTSWAPPED));
    return copy && pyopencv_to<Mat>(copy, m, info);
}

typedef std::vector<Mat> vector_Mat;
typedef std::vector<vector_Mat> vector_vector_Mat;
typedef std::vector<double> vector_double;
typedef std::vector<int> vector_int;
typedef std::vector<String> vector_String;

// The generated code fills tables by position and ignores what it does not need.
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"

struct ConstDef
{
    const char* name;
    long long val;
};

//! Adds a new reference to the module; false and an exception on failure.
static bool addObject(PyObject* module, const char* name, PyObject* object)
{
    if (object && PyModule_AddObject(module, name, object) == 0)    // takes the reference
        return true;
    Py_XDECREF(object);
    return false;
}

//! The type's constructor; a type that has none in C++ must not be made empty in Python.
static int refuseToMake(PyObject* self, PyObject*, PyObject*)
{
    PyErr_Format(PyExc_TypeError, "%R is made by its create functions", (PyObject*)Py_TYPE(self));
    return -1;
}

//! A generated constructor says that all is well after an exception, too, which Python takes for an error of its own.
template<typename Self>
static int construct(int (*constructor)(Self*, PyObject*, PyObject*), PyObject* self, PyObject* args, PyObject* keywords)
{
    const int result = constructor((Self*)self, args, keywords);
    return PyErr_Occurred() ? -1 : result;
}

template<auto constructor> static initproc constructorOf()
{
    if constexpr (std::is_integral<decltype(constructor)>::value)
        return refuseToMake;
    else
        return [](PyObject* self, PyObject* args, PyObject* keywords) { return construct(constructor, self, args, keywords); };
}

static bool registerNewType(PyObject* module, const char* name, PyObject* type, const std::string&)
{
    Py_INCREF(type);
    return addObject(module, name, type);
}

#include "pyopencv_generated_enums.h"

#define CVPY_TYPE(EXPORT_NAME, CLASS_ID, STORAGE, SNAME, _1, _2, SCOPE) \
    CVPY_TYPE_DECLARE_DYNAMIC(EXPORT_NAME, CLASS_ID, STORAGE, SNAME, "")
#include "pyopencv_generated_types.h"
#undef CVPY_TYPE
#include "pyopencv_custom_headers.h"

#include "pyopencv_generated_types_content.h"
#include "pyopencv_generated_funcs.h"
#include "pyopencv_generated_modules_content.h"

static bool addFunctionsAndConstants(PyObject* module, PyMethodDef* methods, const ConstDef* constants)
{
    PyObject* const scope = PyUnicode_FromString(MODULESTR);
    bool ok = scope != NULL;
    for (PyMethodDef* m = methods; ok && m->ml_name; m++)
        ok = addObject(module, m->ml_name, PyCFunction_NewEx(m, NULL, scope));
    for (const ConstDef* c = constants; ok && c->name; c++)
        ok = addObject(module, c->name, PyLong_FromLongLong(c->val));
    Py_XDECREF(scope);
    return ok;
}

//! cv2.error where cv2 is installed, so that a program catches one type; else a type of this module with its attributes.
static PyObject* errorType()
{
    PyObject* const cv2 = PyImport_ImportModule("cv2");
    if (cv2)
    {
        PyObject* const error = PyObject_GetAttrString(cv2, "error");
        Py_DECREF(cv2);
        if (error)
            return error;       // else a folder of that name, or what is left of an installation
    }
    if (!PyErr_ExceptionMatches(PyExc_Exception))
        return NULL;            // an interruption
    PyErr_Clear();
    PyObject* const attributes = Py_BuildValue("{s:O,s:O,s:O,s:O,s:O,s:O}", "file", Py_None, "func", Py_None, "line",
                                               Py_None, "code", Py_None, "msg", Py_None, "err", Py_None);
    PyObject* const error = attributes ? PyErr_NewException(MODULESTR ".error", NULL, attributes) : NULL;
    Py_XDECREF(attributes);
    return error;
}

static bool fill(PyObject* m)
{
#define CVPY_MODULE(NAMESTR, NAME) \
    if (!addFunctionsAndConstants(m, methods_##NAME, consts_##NAME)) \
        return false
#include "pyopencv_generated_modules.h"
#undef CVPY_MODULE

    PyObject* pyopencv_NoBase_TypePtr = NULL;
#define CVPY_TYPE(EXPORT_NAME, CLASS_ID, _1, _2, BASE, CONSTRUCTOR, SCOPE) \
    CVPY_TYPE_INIT_DYNAMIC(EXPORT_NAME, CLASS_ID, return false, BASE, constructorOf<CONSTRUCTOR>(), "")
#include "pyopencv_generated_types.h"
#undef CVPY_TYPE

    opencv_error = errorType();     // a borrowed reference of the module from here on
    return addObject(m, "error", opencv_error)
        && addObject(m, "__version__", PyUnicode_FromString(REFRACT_VERSION));
}

static PyModuleDef moduleDefinition =
{
    PyModuleDef_HEAD_INIT, "_native", "Cameras behind a flat window: the bindings of cv::refract.", -1, NULL
};

PyMODINIT_FUNC PyInit__native()
{
    import_array();
    PyObject* const m = PyModule_Create(&moduleDefinition);
    if (m && fill(m))
        return m;
    Py_XDECREF(m);
    return NULL;
}
