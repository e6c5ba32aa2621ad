// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The extension opencv_refract._native: what OpenCV's generator wrote for refract.hpp, with the conversions of OpenCV's own cv2
// (cv2_convert, cv2_numpy, cv2_util) and ours (conversions.hpp), in a module of its own. It stands in the place of OpenCV's
// cv2.cpp. Arguments are checked in calls.hpp.

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

static String nameOf(PyTypeObject* type);
static void blame(const char* name);

//! Allocates and constructs at once, so that no object without contents can be had. NULL and an exception on failure.
template<typename Self>
static PyObject* make(int (*constructor)(Self*, PyObject*, PyObject*), PyTypeObject* type, PyObject* args, PyObject* keywords)
{
    PyObject* const self = PyType_GenericAlloc(type, 0);
    // A generated constructor says that all is well after a C++ exception, too.
    if (!self || (constructor((Self*)self, args, keywords) == 0 && !PyErr_Occurred()))
        return self;
    Py_DECREF(self);
    blame(nameOf(type).c_str());
    return NULL;
}

//! What a type is called for; one that has no constructor in C++ must not be made empty in Python.
template<auto constructor> static newfunc makerOf()
{
    if constexpr (std::is_integral<decltype(constructor)>::value)
        return [](PyTypeObject* type, PyObject*, PyObject*) -> PyObject*
        { return PyErr_Format(PyExc_TypeError, "%R is made by its create functions", (PyObject*)type); };
    else
        return [](PyTypeObject* type, PyObject* args, PyObject* keywords) { return make(constructor, type, args, keywords); };
}

//! Objects hold a reference of their type, which the generated function keeps.
template<destructor generated> static void destroy(PyObject* self)
{
    PyTypeObject* const type = Py_TYPE(self);
    generated(self);
    Py_DECREF(type);
}

//! A type that none can be derived from: the generated destructor frees what it takes for an object without attributes.
static PyObject* makeType(PyType_Spec& spec, destructor destruct, reprfunc repr, PyGetSetDef* fields, PyMethodDef* methods,
                          newfunc maker, const char* text)
{
    PyType_Slot slots[] = { { Py_tp_dealloc, (void*)destruct }, { Py_tp_repr, (void*)repr }, { Py_tp_getset, fields },
                            { Py_tp_methods, methods }, { Py_tp_new, (void*)maker }, { Py_tp_doc, (void*)text }, { 0, NULL } };
    spec.slots = slots;
    spec.flags = Py_TPFLAGS_DEFAULT;
    return PyType_FromSpec(&spec);
}

#include "pyopencv_generated_enums.h"

#define CVPY_TYPE(EXPORT_NAME, CLASS_ID, STORAGE, SNAME, _1, _2, SCOPE) \
    CVPY_TYPE_DECLARE_DYNAMIC(EXPORT_NAME, CLASS_ID, STORAGE, SNAME, "")
#include "pyopencv_generated_types.h"
#undef CVPY_TYPE
#include "pyopencv_custom_headers.h"
#include "class_texts.h"
#include "calls.hpp"
#include "conversions.hpp"

// As that of cv2_util.hpp, but what is raised has no path of the machine that compiled this, and attributes of its own.
#undef ERRWRAP2
#define ERRWRAP2(expr) \
    try \
    { \
        PyAllowThreads allowThreads; \
        expr; \
    } \
    catch (const cv::Exception& e) \
    { \
        raise(e); \
        return 0; \
    } \
    catch (const std::exception& e) \
    { \
        raise(e.what(), Error::StsError); \
        return 0; \
    }

#include "pyopencv_generated_types_content.h"
#include "pyopencv_generated_funcs.h"
#include "pyopencv_generated_modules_content.h"
#include "window.hpp"
#include "options.hpp"

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
    const char* const text = "A wrong argument, or data without an answer: err says what, code is OpenCV's.";
    PyObject* const error = attributes ? PyErr_NewExceptionWithDoc(MODULESTR ".error", text, NULL, attributes) : NULL;
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

#define CVPY_TYPE(EXPORT_NAME, CLASS_ID, _1, _2, _3, CONSTRUCTOR, _4) \
    pyopencv_##CLASS_ID##_TypePtr = makeType(pyopencv_##CLASS_ID##_Spec, destroy<pyopencv_##CLASS_ID##_dealloc>, \
                                             pyopencv_##CLASS_ID##_repr, pyopencv_##CLASS_ID##_getseters, \
                                             pyopencv_##CLASS_ID##_methods, makerOf<CONSTRUCTOR>(), TEXT_OF_##EXPORT_NAME); \
    Py_XINCREF(pyopencv_##CLASS_ID##_TypePtr);      /* one of the module, one of this variable */ \
    if (!addObject(m, #EXPORT_NAME, pyopencv_##CLASS_ID##_TypePtr)) \
        return false;
#include "pyopencv_generated_types.h"
#undef CVPY_TYPE

    opencv_error = errorType();     // a borrowed reference of the module from here on
    return addObject(m, "error", opencv_error)
        && addObject(m, "__version__", PyUnicode_FromString(REFRACT_VERSION));
}

//! The package's enumeration of flags, which calls take and return.
static PyObject* useFlags(PyObject*, PyObject* type)
{
    Py_INCREF(type);        // as long as the process
    flagsType = type;
    Py_RETURN_NONE;
}

static PyMethodDef ownMethods[] = { { "_use_flags", useFlags, METH_O, "" }, { NULL, NULL, 0, NULL } };

static PyModuleDef moduleDefinition =
{
    PyModuleDef_HEAD_INIT, "_native", "Cameras behind a flat window: the bindings of cv::refract.", -1, ownMethods
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
