// A mirror that shows a parallax probe; parallax_probe() in PROBE.hlsl is what to call from shaders of your own, such as
// a Custom Function node of Shader Graph. The script ParallaxProbesImporter.cs makes the cubemap and a material of it.
Shader "Parallax Probes/PROBE"
{
    Properties
    {
        pp_levels ("Levels", Cube) = "black" {}
        _Roughness ("Roughness", Range(0, 1)) = 0
    }
    SubShader
    {
        Tags { "RenderType" = "Opaque" }
        Pass
        {
            HLSLPROGRAM
            #pragma target 4.0
            #pragma vertex vert
            #pragma fragment frag
            #include "UnityCG.cginc"
            #include "PROBE.hlsl"

            TextureCube pp_levels;
            SamplerState sampler_pp_levels;
            float _Roughness;

            struct Seen
            {
                float4 clip : SV_POSITION;
                float3 place : TEXCOORD0;
                float3 normal : TEXCOORD1;
            };

            Seen vert(float4 vertex : POSITION, float3 normal : NORMAL)
            {
                Seen seen;
                seen.clip = UnityObjectToClipPos(vertex);
                seen.place = mul(unity_ObjectToWorld, vertex).xyz;
                seen.normal = UnityObjectToWorldNormal(normal);
                return seen;
            }

            float4 frag(Seen at) : SV_Target
            {
                float3 incoming = normalize(_WorldSpaceCameraPos - at.place);
                float3 normal = normalize(at.normal);
                float4 seen = parallax_probe(pp_levels, sampler_pp_levels, at.place, incoming, normal, _Roughness);
                return float4(seen.rgb * seen.a, 1.0);
            }
            ENDHLSL
        }
    }
}
