// Turns an export of Parallax Probes into cubemaps with their own levels, and materials that show them.
// Put the whole folder into Assets, select parallax_probes.json there, then Assets > Import Parallax Probes.
#if UNITY_EDITOR
using System;
using System.IO;
using UnityEditor;
using UnityEngine;

public static class ParallaxProbesImporter
{
    const int HeaderBytes = 128;
    const int TexelBytes = 8;

    [Serializable] class Pictures { public string dds; }
    [Serializable] class Probe { public string name; public string shader; public Pictures pictures; public int face_width; }
    [Serializable] class Export { public string format; public string target; public Probe[] probes; }

    [MenuItem("Assets/Import Parallax Probes")]
    static void Import()
    {
        string listing = AssetDatabase.GetAssetPath(Selection.activeObject);
        string folder = Path.GetDirectoryName(listing);
        Export export = JsonUtility.FromJson<Export>(File.ReadAllText(listing));
        if (export.format != "parallax-probes-export" || export.target != "unity")
            throw new Exception(listing + " is no export of Parallax Probes for Unity; select its parallax_probes.json");
        foreach (Probe probe in export.probes)
        {
            string stem = Path.Combine(folder, Path.GetFileNameWithoutExtension(probe.shader));
            Cubemap levels = LevelsOf(Path.Combine(folder, probe.pictures.dds), probe.face_width);
            AssetDatabase.CreateAsset(levels, stem + ".cubemap");
            Material material = new Material(AssetDatabase.LoadAssetAtPath<Shader>(stem + ".shader"));
            material.SetTexture("pp_levels", levels);
            AssetDatabase.CreateAsset(material, stem + ".mat");
        }
        AssetDatabase.SaveAssets();
    }

    // A face after the other, each with all its levels: as the file has them and as Unity numbers them.
    static Cubemap LevelsOf(string path, int width)
    {
        byte[] file = File.ReadAllBytes(path);
        Cubemap cubemap = new Cubemap(width, TextureFormat.RGBAHalf, true);
        int at = HeaderBytes;
        for (int face = 0; face < 6; face++)
        {
            for (int level = 0; level < cubemap.mipmapCount; level++)
            {
                int across = Math.Max(width >> level, 1);
                byte[] texels = new byte[across * across * TexelBytes];
                Array.Copy(file, at, texels, 0, texels.Length);
                cubemap.SetPixelData(texels, level, (CubemapFace)face);
                at += texels.Length;
            }
        }
        cubemap.filterMode = FilterMode.Trilinear;
        cubemap.Apply(false);
        return cubemap;
    }
}
#endif
